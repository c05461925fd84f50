#include "solve/free_motions.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace amontons {

namespace {

/// A body that one facet of contact holds has a ratio rᵀ K r / rᵀ diag(K) r of about one over the number of nodes; one
/// that SupportForm alone holds 1e-8 of that, at most 1e-6 (3D, a hundred cells across).
constexpr double free_below = 1e-5;
/// Part of an axis motion that must be free for it to be named.
constexpr double named_above = 0.9;

/// Nodes of this rank by body; the centre and size of each body over all ranks.
struct Bodies {
  std::vector<std::vector<std::int32_t>> nodes;
  std::vector<std::array<double, 3>> low, high;

  explicit Bodies(const Mesh& mesh) : nodes(mesh.bodies.size()), low(nodes.size()), high(nodes.size()) {
    for (const auto& block : mesh.blocks)
      nodes[block.body].insert(nodes[block.body].end(), block.nodes.begin(), block.nodes.end());
    for (std::size_t b = 0; b < nodes.size(); ++b) {
      std::sort(nodes[b].begin(), nodes[b].end());
      nodes[b].erase(std::unique(nodes[b].begin(), nodes[b].end()), nodes[b].end());
      low[b].fill(1e300);
      high[b].fill(-1e300);
      for (const auto node : nodes[b])
        for (int c = 0; c < mesh.dim; ++c) {
          low[b][c] = std::min(low[b][c], mesh.position(node)[c]);
          high[b][c] = std::max(high[b][c], mesh.position(node)[c]);
        }
    }
    const int size = static_cast<int>(3 * nodes.size());
    MPI_Allreduce(MPI_IN_PLACE, low.data(), size, MPI_DOUBLE, MPI_MIN, mesh.comm);
    MPI_Allreduce(MPI_IN_PLACE, high.data(), size, MPI_DOUBLE, MPI_MAX, mesh.comm);
  }
};

/// Component c of rigid motion `mode` (dim translations, then rotations) at r, the place from the centre over the size.
double rigid_motion(int dim, int mode, int c, const std::array<double, 3>& r) {
  if (mode < dim) return mode == c ? 1.0 : 0.0;
  if (dim == 2) return c == 0 ? -r[1] : r[0];
  const int axis = mode - dim; // e_axis × r
  if (c == (axis + 1) % 3) return -r[(axis + 2) % 3];
  if (c == (axis + 2) % 3) return r[(axis + 1) % 3];
  return 0.0;
}

std::string direction_name(int dim, int mode) {
  if (mode < dim) return std::string("along ") + "xyz"[mode];
  return std::string("about ") + (dim == 2 ? 'z' : "xyz"[mode - dim]);
}

/// One vector per body and mode, zero in equations of prescribed displacements: those do not give way.
std::vector<VecHandle> rigid_vectors(const Problem& problem, const Bodies& bodies, int modes) {
  const auto& layout = problem.layout();
  const auto& mesh = layout.mesh();
  std::vector<VecHandle> vectors;
  for (std::size_t b = 0; b < bodies.nodes.size(); ++b) {
    double size = 0.0;
    for (int c = 0; c < mesh.dim; ++c)
      size = std::max(size, bodies.high[b][c] - bodies.low[b][c]);
    for (int mode = 0; mode < modes; ++mode) {
      vectors.push_back(layout.new_vector());
      VecArray values(vectors.back());
      for (const auto node : bodies.nodes[b]) {
        std::array<double, 3> r{};
        for (int c = 0; c < mesh.dim; ++c)
          r[c] = (mesh.position(node)[c] - 0.5 * (bodies.low[b][c] + bodies.high[b][c])) / size;
        for (int c = 0; c < mesh.dim; ++c) {
          const PetscInt local = layout.equation(node, c) - layout.first_equation();
          if (local >= 0 && local < layout.num_owned() && !problem.is_prescribed(local + layout.first_equation()))
            values[local] = rigid_motion(mesh.dim, mode, c, r);
        }
      }
    }
  }
  return vectors;
}

} // namespace

std::vector<FreeMotion> find_free_motions(const Problem& problem, Mat tangent) {
  const auto& mesh = problem.layout().mesh();
  const Bodies bodies(mesh);
  const int modes = mesh.dim == 2 ? 3 : 6;
  const auto vectors = rigid_vectors(problem, bodies, modes);
  const auto diagonal = problem.layout().new_vector(), product = problem.layout().new_vector();
  AMT_PETSC(MatGetDiagonal(tangent, diagonal));
  AMT_PETSC(VecAbs(diagonal));
  const auto count = static_cast<Eigen::Index>(vectors.size());
  Eigen::MatrixXd stiffness(count, count), scale(count, count);
  const auto dots = [&](Eigen::MatrixXd& result, Eigen::Index column) {
    for (Eigen::Index row = 0; row < count; ++row)
      AMT_PETSC(VecDot(vectors[row], product, &result(row, column)));
  };
  for (Eigen::Index column = 0; column < count; ++column) {
    AMT_PETSC(MatMult(tangent, vectors[column], product));
    dots(stiffness, column);
    AMT_PETSC(VecPointwiseMult(product, diagonal, vectors[column]));
    dots(scale, column);
  }
  if (!stiffness.allFinite() || !scale.allFinite()) return {};
  // A motion that supports suppress altogether has no scale; it is not free.
  const double floor = 1e-12 * std::max(scale.diagonal().maxCoeff(), 1e-300);
  for (Eigen::Index i = 0; i < count; ++i)
    if (scale(i, i) <= floor) scale(i, i) = stiffness(i, i) = 1.0;
  const Eigen::MatrixXd symmetric = 0.5 * (stiffness + stiffness.transpose());
  // Eigenvectors are orthonormal in `scale`.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric, scale);
  if (solver.info() != Eigen::Success) return {};
  const double limit = free_below / static_cast<double>(mesh.num_global);
  const auto num_free = std::count_if(solver.eigenvalues().begin(), solver.eigenvalues().end(),
                                      [&](double value) { return value < limit; });
  const Eigen::MatrixXd parts = solver.eigenvectors().leftCols(num_free).transpose() * scale; // of each axis motion
  std::vector<FreeMotion> found;
  for (std::size_t b = 0; b < bodies.nodes.size(); ++b) {
    bool takes_part = false, is_named = false;
    for (int mode = 0; mode < modes; ++mode) {
      const Eigen::Index i = static_cast<Eigen::Index>(b) * modes + mode;
      const double part = parts.col(i).squaredNorm() / scale(i, i);
      takes_part = takes_part || part > 1.0 - named_above;
      if (part <= named_above) continue;
      is_named = true;
      found.push_back({mesh.bodies[b], direction_name(mesh.dim, mode)});
    }
    if (takes_part && !is_named) found.push_back({mesh.bodies[b], "(several directions at once)"});
  }
  return found;
}

} // namespace amontons
