#include "path_record.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace amontons {

double PathRecord::add(const PathDifference& difference, KeptSolution kept) {
  const double factor = kept == KeptSolution::Halves ? 1.0 : 2.0;
  sum_.displacement += factor * difference.displacement;
  sum_.pressure += factor * difference.pressure;
  sum_.shear += factor * difference.shear;
  sum_.status = std::max(sum_.status, difference.status);
  ++measured_;
  return factor * difference.largest();
}

void PathRecord::add_cost(int newton_iterations, double seconds) {
  newton_ += newton_iterations;
  seconds_ += seconds;
}

nlohmann::ordered_json PathRecord::to_json() const {
  return {
      {"estimated_error", sum_.largest()},
      {"displacement", sum_.displacement},
      {"pressure", sum_.pressure},
      {"shear", sum_.shear},
      {"largest_status_difference", sum_.status},
      {"meaning",
       "sum over the increments of how far the kept solution is off for the size of the increment, assuming a local "
       "error of second order; each relative to the largest displacement, pressure or shear limit so far"},
      {"compared", measured_},
      {"not_compared", unmeasured_},
      {"rejected", rejected_},
      {"beyond_tolerance", beyond_},
      {"extra_newton_iterations", newton_},
      {"extra_seconds", seconds_}};
}

void PathRecord::save(Checkpoint& checkpoint) const {
  checkpoint.global["path"] = {sum_.displacement, sum_.pressure,     sum_.shear,          sum_.status,
                               seconds_,          double(measured_), double(unmeasured_), double(rejected_),
                               double(beyond_),   double(newton_)};
  auto& values = checkpoint.global["path_scales"];
  values = {scales.displacement};
  for (const auto& pair : scales.pairs)
    values.insert(values.end(), {pair.pressure, pair.shear, pair.traction, pair.area});
}

void PathRecord::restore(const Checkpoint& checkpoint) {
  const auto& values = checkpoint.global.at("path");
  sum_ = {.displacement = values.at(0), .pressure = values.at(1), .shear = values.at(2), .status = values.at(3)};
  seconds_ = values.at(4);
  int* const counts[] = {&measured_, &unmeasured_, &rejected_, &beyond_, &newton_};
  for (std::size_t i = 0; i < 5; ++i)
    *counts[i] = static_cast<int>(values.at(5 + i));
  const auto& sizes = checkpoint.global.at("path_scales");
  scales = {.displacement = sizes.at(0), .pairs = {}};
  for (std::size_t i = 1; i + 3 < sizes.size(); i += 4)
    scales.pairs.push_back(
        {.pressure = sizes[i], .shear = sizes[i + 1], .traction = sizes[i + 2], .area = sizes[i + 3]});
}

} // namespace amontons
