#include "accuracy/goal_error.hpp"

#include "accuracy/recovery_error.hpp"

#include <array>
#include <cmath>

namespace amontons {

namespace {

/// Of a field in a cell, at the points where products of two fields are integrated.
struct CellParts {
  Eigen::MatrixXd strain, stress; // recovered minus computed
  Eigen::VectorXd pressure;       // recovered mean stress
  Eigen::VectorXd left_out;       // see left_out_dilatation
  Eigen::VectorXd volumes;
};

/// Visits all cells with their numbers.
void each_cell(SolidForm& solid, const Mesh& mesh, const State& state,
               const std::function<void(std::size_t, CellParts)>& visit) {
  const accuracy::PatchRecovery recovery(solid, mesh, state);
  const accuracy::CellIndex index(mesh);
  solid.for_each_batch(state, [&](const PointBatch& batch) {
    const accuracy::ErrorRule rule(*batch.table);
    for (std::int32_t c = 0; c < batch.num_cells; ++c) {
      const auto cell = accuracy::difference(recovery, rule, mesh, batch, c);
      const auto half = cell.error.cols() / 2;
      visit(index(batch, c),
            {.strain = cell.error.leftCols(half),
             .stress = cell.error.rightCols(half),
             .pressure = (cell.error + cell.fields).middleCols(half, 3).rowwise().sum() / 3.0,
             .left_out = accuracy::left_out_dilatation(solid.space(), mesh, batch, c, state.displacement),
             .volumes = cell.volumes});
    }
  });
}

/// ∫ Δσ(u) : Δε(z) − p*(u) δ(z) − p*(z) δ(u).
double part(const CellParts& state, const CellParts& influence) {
  Eigen::VectorXd density = state.stress.cwiseProduct(influence.strain).rowwise().sum();
  if (state.left_out.size() == density.size()) // else simplices, which have another rule here and nothing left out
    density -= state.pressure.cwiseProduct(influence.left_out) + influence.pressure.cwiseProduct(state.left_out);
  return density.dot(state.volumes);
}

} // namespace

std::vector<GoalError> estimate_goal_errors(SolidForm& solid, const Mesh& mesh, const State& state,
                                            std::span<const std::vector<double>> influences) {
  // The state's parts are kept, those of the influences pass by: the memory does not grow with the figures.
  std::vector<CellParts> of_state(accuracy::CellIndex(mesh).size());
  each_cell(solid, mesh, state, [&](std::size_t cell, CellParts parts) { of_state[cell] = std::move(parts); });
  std::vector<GoalError> goals;
  for (const auto& influence : influences) {
    auto& goal = goals.emplace_back();
    goal.cells.resize(of_state.size());
    each_cell(solid, mesh, State{.displacement = influence}, [&](std::size_t cell, const CellParts& parts) {
      const double value = part(of_state[cell], parts);
      goal.error += value;
      goal.cells[cell] = std::abs(value);
      goal.bound += goal.cells[cell];
    });
  }
  for (auto& goal : goals) {
    std::array<double, 2> sums{goal.error, goal.bound};
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), sums.size(), MPI_DOUBLE, MPI_SUM, mesh.comm);
    goal.error = sums[0];
    goal.bound = sums[1];
  }
  return goals;
}

} // namespace amontons
