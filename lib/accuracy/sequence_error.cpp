#include "accuracy/sequence_error.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

std::optional<double> sequence_error(std::span<const double> values, std::span<const double> energy_errors) {
  constexpr double largest_ratio = 0.8;
  const std::size_t n = values.size();
  if (n < 3 || values[n - 1] == 0.0) return std::nullopt;
  const double ratio =
      energy_errors[n - 2] > 0.0 ? std::min(largest_ratio, energy_errors[n - 1] / energy_errors[n - 2]) : largest_ratio;
  const double step =
      std::max(std::abs(values[n - 1] - values[n - 2]), ratio * std::abs(values[n - 2] - values[n - 3]));
  return step * ratio / (1.0 - ratio) / std::abs(values[n - 1]);
}

} // namespace amontons
