#include "adaptation.hpp"

#include "accuracy/sequence_error.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "wall_clock.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

/// What one pass may take the error to: the estimate is good near the mesh that it was made on, and a mesh that is much
/// finer costs as much as all before it together.
constexpr double strongest_reduction = 0.35, weakest_reduction = 0.7, blind_reduction = 0.5;
/// The target is aimed at with this margin, so that it is not missed by a little.
constexpr double margin = 0.9;
/// Cells of the next mesh, counted by the rule, are this part of those that fit: slopes of sizes add some.
constexpr double room = 0.75;

const char* quantity_name(AdaptQuantity quantity) {
  const char* const names[] = {"peak_pressure", "force", "energy", "energy_norm"}; // in the order of AdaptQuantity
  return names[static_cast<std::size_t>(quantity)];
}

const char* quantity_method(AdaptQuantity quantity) {
  switch (quantity) {
  case AdaptQuantity::Energy:
    return "square of the error in the energy norm by patch recovery (Zienkiewicz and Zhu, 1992): the error of the "
           "stored energy under given forces";
  case AdaptQuantity::EnergyNorm:
    return "patch recovery (Zienkiewicz and Zhu, 1992), in the energy norm";
  default:
    return "influence of the cells' errors on the quantity (dual weighted residual, recovered stresses), without "
           "their cancelling, for a peak with what linear pressures may be off there, or what the quantity has changed "
           "since the last mesh if that is more, where it is linear "
           "elastic, frictionless and not `vi` or with the dual basis; else the "
           "change of the quantity from pass to pass, continued as if its error fell as that in the energy norm, which "
           "is slower than it does where it is smooth; no bound";
  }
}

} // namespace

Adaptation::Adaptation(const Deck& deck)
    : started_(now()), adapt_(*deck.adapt), first_mesh_(deck.mesh.file.place), dim_(deck.dim()) {
  for (std::size_t i = 0; adapt_.pair && i < deck.contact.size(); ++i)
    if (deck.contact[i].name.value == *adapt_.pair) pair_ = i;
}

bool Adaptation::fits(std::int64_t unknowns) {
  const double excess = static_cast<double>(unknowns) / adapt_.max_unknowns;
  if (excess <= 1.0) return true;
  if (results_.empty())
    throw UserError(first_mesh_.text() + ": the first mesh has " + std::to_string(unknowns) +
                    " unknowns, more than adapt.max_unknowns allows. Make it coarser with mesh.parameters, or raise "
                    "max_unknowns.");
  set_sizes(1.1 * std::pow(excess, 1.0 / dim_));
  return false;
}

void Adaptation::set_sizes(double factor) {
  if (samples_.empty()) return; // not rank 0
  for (auto& sample : samples_)
    sample.size *= factor;
  meshing_.sizes = std::make_shared<const SizeField>(samples_, usual_growth);
}

const FigureError* Adaptation::figure(const FigureErrors& figures) const {
  const std::string wanted = quantity_name(adapt_.quantity);
  for (const auto& figure : figures.figures)
    if (figure.figure == wanted && (!adapt_.pair || figure.pair == *adapt_.pair)) return &figure;
  return nullptr;
}

std::optional<double> Adaptation::figure_error(const FigureErrors& figures) const {
  const auto* found = figure(figures);
  return found ? std::optional(found->bound) : std::nullopt;
}

void Adaptation::see(const Scene& scene, const DiscretizationError& error, const FigureErrors& figures) {
  // Both fall like the square of the error in the energy norm.
  const auto* goal = figure(figures);
  const auto& parts = goal ? goal->cells : error.cells;
  squares_.resize(parts.size(), 0.0);
  near_edge_.resize(parts.size(), 0);
  for (std::size_t c = 0; c < parts.size(); ++c) {
    squares_[c] = std::max(squares_[c], parts[c]);
    near_edge_[c] = near_edge_[c] || error.cell_near_edge[c];
  }
  cells_ = simplex_errors(scene.mesh, squares_, near_edge_);
}

double Adaptation::value(const PassResult& result) const {
  switch (adapt_.quantity) {
  case AdaptQuantity::PeakPressure:
    return result.pairs[pair_].max_pressure;
  case AdaptQuantity::Force: {
    const auto& force = result.pairs[pair_].force;
    return std::hypot(force[0], force[1], force[2]);
  }
  case AdaptQuantity::Energy:
    return result.energy;
  case AdaptQuantity::EnergyNorm:
    return result.mesh_error;
  }
  return 0.0;
}

std::optional<double> Adaptation::estimate() const {
  if (results_.back().figure) {
    // Blind to how well so few points of contact can follow the pressure at all, so not trusted on one mesh.
    if (results_.size() == 1) return std::nullopt;
    const double now = value(results_.back()), before = value(results_[results_.size() - 2]);
    return std::max(*results_.back().figure, std::abs(now - before) / std::max(std::abs(now), 1e-300));
  }
  const double mesh_error = results_.back().mesh_error;
  if (adapt_.quantity == AdaptQuantity::EnergyNorm) return mesh_error;
  if (adapt_.quantity == AdaptQuantity::Energy) return mesh_error * mesh_error;
  std::vector<double> values, mesh_errors;
  for (const auto& result : results_) {
    values.push_back(value(result));
    mesh_errors.push_back(result.mesh_error);
  }
  return sequence_error(values, mesh_errors);
}

/// What the error in the energy norm of the next mesh shall be, over that of this one.
double Adaptation::reduction(std::optional<double> error) const {
  if (!error) return blind_reduction;
  const bool is_square = adapt_.quantity == AdaptQuantity::Energy || results_.back().figure;
  const double power = is_square ? 0.5 : 1.0;
  return std::clamp(margin * std::pow(adapt_.target_error / *error, power), strongest_reduction, weakest_reduction);
}

/// Returns whether the next mesh has room for a smaller error.
bool Adaptation::choose_sizes(MPI_Comm comm, double reduction) {
  int worth_it = 1;
  on_root(comm, [&] {
    double square = 0.0;
    for (const auto& cell : cells_)
      square += cell.square;
    const auto& last = results_.back();
    const double most =
        room * adapt_.max_unknowns / static_cast<double>(last.unknowns) * static_cast<double>(last.cells);
    const auto wanted =
        wanted_sizes(cells_, {.dim = dim_, .target = reduction * std::sqrt(square), .most_cells = most});
    samples_ = wanted.samples;
    worth_it = !samples_.empty() && wanted.error < 0.9 * std::sqrt(square);
    if (worth_it) set_sizes(1.0);
  });
  MPI_Bcast(&worth_it, 1, MPI_INT, 0, comm);
  return worth_it != 0;
}

void Adaptation::close(MPI_Comm comm, PassResult result) {
  results_.push_back(std::move(result));
  errors_.push_back(estimate());
  if (errors_.back() && *errors_.back() <= adapt_.target_error)
    verdict_ = Verdict::Reached;
  else if (static_cast<int>(results_.size()) >= adapt_.max_passes)
    verdict_ = Verdict::PassesSpent;
  else if (!choose_sizes(comm, reduction(errors_.back())))
    verdict_ = Verdict::UnknownsSpent;
  squares_.clear();
  near_edge_.clear();
}

nlohmann::ordered_json Adaptation::to_json() const {
  const char* const outcomes[] = {"goes on", "target reached", "target not reached: no room for more unknowns",
                                  "target not reached: no passes left"}; // in the order of Verdict
  nlohmann::ordered_json passes = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < results_.size(); ++i) {
    const auto& result = results_[i];
    passes.push_back({{"unknowns", result.unknowns},
                      {"cells", result.cells},
                      {"value", value(result)},
                      {"error", errors_[i] ? nlohmann::ordered_json(*errors_[i]) : nlohmann::ordered_json()},
                      {"error_energy_norm", result.mesh_error},
                      {"wall_seconds", result.wall_seconds}});
  }
  return {{"quantity", quantity_name(adapt_.quantity)},
          {"target_error", adapt_.target_error},
          {"outcome", outcomes[static_cast<std::size_t>(verdict_)]},
          {"reached", verdict_ == Verdict::Reached},
          {"method", quantity_method(adapt_.quantity)},
          {"passes", passes}};
}

std::string Adaptation::sentence() const {
  const auto& last = results_.back();
  std::string line = formatted("pass %zu: %lld unknowns, %s %.6g, ", results_.size(),
                               static_cast<long long>(last.unknowns), quantity_name(adapt_.quantity), value(last));
  line += errors_.back() ? formatted("error about %.2g %%", 100 * *errors_.back())
                         : std::string("error not yet known: it takes more passes");
  switch (verdict_) {
  case Verdict::GoesOn:
    return line + "; a finer mesh follows";
  case Verdict::Reached:
    return line + formatted("; the target of %.2g %% is reached", 100 * adapt_.target_error);
  case Verdict::UnknownsSpent:
    return line + formatted("; the target of %.2g %% is NOT reached, and %g unknowns leave no room. Raise "
                            "adapt.max_unknowns.",
                            100 * adapt_.target_error, adapt_.max_unknowns);
  case Verdict::PassesSpent:
    return line + formatted("; the target of %.2g %% is NOT reached in %d passes. Raise adapt.max_passes.",
                            100 * adapt_.target_error, adapt_.max_passes);
  }
  return line;
}

} // namespace amontons
