#include "accuracy/mesh_sizes.hpp"

#include "accuracy/facet_cloud.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

constexpr double rate_at_edge = 1.5;

/// Area or volume of the simplex of the cell's corners.
double simplex_volume(const Mesh& mesh, std::span<const std::int32_t> corners) {
  const int dim = mesh.dim;
  Eigen::MatrixXd sides(dim, dim);
  for (int a = 0; a < dim; ++a)
    for (int i = 0; i < dim; ++i)
      sides(i, a) = mesh.position(corners[a + 1])[i] - mesh.position(corners[0])[i];
  return std::abs(sides.determinant()) / (dim == 2 ? 2.0 : 6.0);
}

/// The rule's ratio r of every cell for one c.
struct Division {
  std::span<const CellError> cells;
  const SizeRule& rule;

  double ratio(const CellError& cell, double log_c) const {
    if (cell.square <= 0.0) return rule.coarsest;
    const double power = (log_c - std::log(cell.rate * cell.square)) / (2.0 * cell.rate + rule.dim);
    return std::exp(std::clamp(power, std::log(rule.finest), std::log(rule.coarsest)));
  }
  double square(double log_c) const {
    double sum = 0.0;
    for (const auto& cell : cells)
      sum += cell.square * std::pow(ratio(cell, log_c), 2.0 * cell.rate);
    return sum;
  }
  double count(double log_c) const {
    double sum = 0.0;
    for (const auto& cell : cells)
      sum += std::pow(ratio(cell, log_c), -rule.dim);
    return sum;
  }
};

/// Four digits: the same sizes, and so the same mesh, on any number of ranks, whose sums differ in the last digits.
double rounded(double size) {
  const double unit = std::pow(10.0, std::floor(std::log10(size)) - 3.0);
  return std::round(size / unit) * unit;
}

/// The largest x in [low, high] with holds(x), for which it holds below some point and not above; `low` if nowhere.
template <class Holds>
double last_that(double low, double high, Holds holds) {
  if (holds(high)) return high;
  for (int step = 0; step < 100; ++step) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

} // namespace

std::vector<CellError> simplex_errors(const Mesh& mesh, std::span<const double> squares,
                                      std::span<const std::uint8_t> near_edge) {
  constexpr std::size_t width = 6; // place, edge, square, rate
  std::vector<double> mine;
  std::size_t next = 0;
  for (const auto& block : mesh.blocks)
    for (std::int32_t c = 0; c < block.size(); ++c, ++next) {
      const auto corners = block.cell(c).first(static_cast<std::size_t>(num_vertices(block.type)));
      std::array<double, 3> place{};
      for (const auto node : corners)
        for (int i = 0; i < mesh.dim; ++i)
          place[i] += mesh.position(node)[i] / static_cast<double>(corners.size());
      const double order = mesh.order, rate = near_edge[next] ? std::min(order, rate_at_edge) : order;
      mine.insert(mine.end(), {place[0], place[1], place[2], equilateral_edge(mesh.dim, simplex_volume(mesh, corners)),
                               squares[next], rate});
    }
  int ranks = 1;
  MPI_Comm_size(mesh.comm, &ranks);
  std::vector<std::vector<double>> outgoing(ranks);
  outgoing[0] = std::move(mine);
  const auto all = accuracy::exchanged(mesh.comm, outgoing);
  std::vector<CellError> cells;
  for (std::size_t i = 0; i + width <= all.size(); i += width)
    cells.push_back({{all[i], all[i + 1], all[i + 2]}, all[i + 3], all[i + 4], all[i + 5]});
  return cells;
}

WantedSizes wanted_sizes(std::span<const CellError> cells, const SizeRule& rule) {
  const Division division{cells, rule};
  double low = 1e300, high = -1e300; // of log c, between which not all ratios are at a limit
  for (const auto& cell : cells) {
    if (cell.square <= 0.0) continue;
    const double power = 2.0 * cell.rate + rule.dim, own = std::log(cell.rate * cell.square);
    low = std::min(low, own + power * std::log(rule.finest));
    high = std::max(high, own + power * std::log(rule.coarsest));
  }
  WantedSizes wanted;
  if (low > high) return wanted;
  // Both grow the other way: a larger c makes larger cells, fewer of them, and a larger error.
  const double goal = rule.target * rule.target;
  double log_c = last_that(low, high, [&](double x) { return division.square(x) <= goal; });
  if (division.count(log_c) > rule.most_cells)
    log_c = -last_that(-high, -low, [&](double x) { return division.count(-x) <= rule.most_cells; });
  for (const auto& cell : cells)
    wanted.samples.push_back(
        {.place = cell.place, .radius = 0.5 * cell.edge, .size = rounded(cell.edge * division.ratio(cell, log_c))});
  wanted.error = std::sqrt(division.square(log_c));
  wanted.cells = division.count(log_c);
  return wanted;
}

} // namespace amontons
