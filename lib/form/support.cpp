// A rigid motion r(X) = translation or rotation about the body's centre survives when it vanishes in every prescribed
// component: when the Gram matrix Σ r_i r_j over the prescribed components is singular.
#include "form/support.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

namespace amontons {

namespace {

/// Box of each body: low and high corner, over all ranks. Collective.
struct BodyBox {
  std::array<double, 3> low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  double diagonal(int dim) const {
    double sum = 0.0;
    for (int c = 0; c < dim; ++c)
      sum += (high[c] - low[c]) * (high[c] - low[c]);
    return std::sqrt(sum);
  }
};

std::vector<std::set<std::int32_t>> nodes_of_bodies(const Mesh& mesh) {
  std::vector<std::set<std::int32_t>> nodes(mesh.bodies.size());
  for (const auto& block : mesh.blocks)
    nodes[block.body].insert(block.nodes.begin(), block.nodes.end());
  return nodes;
}

std::vector<BodyBox> boxes_of_bodies(const Mesh& mesh, const std::vector<std::set<std::int32_t>>& nodes) {
  std::vector<BodyBox> boxes(nodes.size());
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    for (const auto node : nodes[b])
      for (int c = 0; c < mesh.dim; ++c) {
        boxes[b].low[c] = std::min(boxes[b].low[c], mesh.position(node)[c]);
        boxes[b].high[c] = std::max(boxes[b].high[c], mesh.position(node)[c]);
      }
    MPI_Allreduce(MPI_IN_PLACE, boxes[b].low.data(), 3, MPI_DOUBLE, MPI_MIN, mesh.comm);
    MPI_Allreduce(MPI_IN_PLACE, boxes[b].high.data(), 3, MPI_DOUBLE, MPI_MAX, mesh.comm);
  }
  return boxes;
}

/// Component c of each rigid motion at a place relative to the centre, in units of the body's size: dim translations,
/// then rotations.
std::array<double, 6> rigid_motions(int dim, int c, const std::array<double, 3>& r, bool axisymmetric) {
  std::array<double, 6> motions{};
  if (axisymmetric) {
    motions[0] = c == 1 ? 1.0 : 0.0;
    return motions;
  }
  motions[c] = 1.0;
  if (dim == 2) {
    motions[2] = c == 0 ? -r[1] : r[0];
    return motions;
  }
  for (int axis = 0; axis < 3; ++axis) { // component c of e_axis × r
    if (c == (axis + 1) % 3) motions[3 + axis] = -r[(axis + 2) % 3];
    if (c == (axis + 2) % 3) motions[3 + axis] = r[(axis + 1) % 3];
  }
  return motions;
}

} // namespace

std::vector<std::uint8_t> find_floating_bodies(const Mesh& mesh, const std::vector<PrescribedDisplacement>& prescribed,
                                               bool axisymmetric) {
  const auto nodes = nodes_of_bodies(mesh);
  const auto boxes = boxes_of_bodies(mesh, nodes);
  const int motions = axisymmetric ? 1 : mesh.dim == 2 ? 3 : 6;
  std::vector<std::uint8_t> floating(nodes.size());
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    const double size = boxes[b].diagonal(mesh.dim);
    Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
    for (const auto& condition : prescribed)
      for (const auto node : mesh.node_groups.at(condition.group)) {
        if (!nodes[b].count(node)) continue;
        std::array<double, 3> r{};
        for (int c = 0; c < mesh.dim; ++c)
          r[c] = (mesh.position(node)[c] - 0.5 * (boxes[b].low[c] + boxes[b].high[c])) / size;
        const auto motion = rigid_motions(mesh.dim, condition.component, r, axisymmetric);
        for (int i = 0; i < 6; ++i)
          for (int j = 0; j < 6; ++j)
            gram(i, j) += motion[i] * motion[j];
      }
    MPI_Allreduce(MPI_IN_PLACE, gram.data(), 36, MPI_DOUBLE, MPI_SUM, mesh.comm);
    const Eigen::MatrixXd part = gram.topLeftCorner(motions, motions);
    const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(part).eigenvalues();
    floating[b] = eigenvalues[0] <= 1e-10 * std::max(1.0, eigenvalues[motions - 1]);
  }
  return floating;
}

std::vector<double> body_diagonals(const Mesh& mesh) {
  std::vector<double> diagonals;
  for (const auto& box : boxes_of_bodies(mesh, nodes_of_bodies(mesh)))
    diagonals.push_back(box.diagonal(mesh.dim));
  return diagonals;
}

SupportForm::SupportForm(const DofLayout& layout, const std::vector<std::uint8_t>& floating,
                         const std::vector<double>& stiffness)
    : layout_(layout), node_stiffness_(layout.mesh().num_owned, 0.0) {
  const auto& mesh = layout.mesh();
  const auto nodes = nodes_of_bodies(mesh);
  const auto boxes = boxes_of_bodies(mesh, nodes);
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    std::int64_t count =
        std::count_if(nodes[b].begin(), nodes[b].end(), [&](auto node) { return node < mesh.num_owned; });
    MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_INT64_T, MPI_SUM, mesh.comm);
    if (!floating[b]) continue;
    const double total = support_ratio * stiffness[b] * std::pow(boxes[b].diagonal(mesh.dim), mesh.dim - 2);
    for (const auto node : nodes[b])
      if (node < mesh.num_owned) node_stiffness_[node] += total / static_cast<double>(count);
  }
}

void SupportForm::add_tangent(const State&, Tangent& tangent) {
  for (std::size_t node = 0; node < node_stiffness_.size(); ++node)
    if (node_stiffness_[node] > 0.0)
      for (int c = 0; c < layout_.dim(); ++c) {
        const PetscInt equation = layout_.equation(static_cast<std::int32_t>(node), c);
        tangent.add({&equation, 1}, {&node_stiffness_[node], 1});
      }
}

} // namespace amontons
