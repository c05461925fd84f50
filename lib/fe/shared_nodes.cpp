#include "fe/shared_nodes.hpp"

#include <numeric>

namespace amontons {

namespace {

/// Local nodes that other ranks have, too: each rank counts one for its own.
std::vector<std::int32_t> nodes_of_several_ranks(const Mesh& mesh) {
  NodeField everywhere{.name = "", .nodes = std::vector<std::int32_t>(mesh.num_local())};
  std::iota(everywhere.nodes.begin(), everywhere.nodes.end(), 0);
  std::vector<std::vector<double>> counts = {std::vector<double>(mesh.num_local(), 1.0)};
  const NodeSpace space(mesh, {std::move(everywhere)});
  const auto sums = space.new_vector();
  space.add(counts, sums);
  space.gather(sums, counts);
  std::vector<std::int32_t> shared;
  for (std::int32_t node = 0; node < mesh.num_local(); ++node)
    if (counts[0][node] > 1.5) shared.push_back(node);
  return shared;
}

} // namespace

SharedNodes::SharedNodes(const Mesh& mesh, int components)
    : components_(components), nodes_(nodes_of_several_ranks(mesh)), is_shared_(mesh.num_local(), 0),
      space_(mesh, std::vector<NodeField>(components, NodeField{.name = "", .nodes = nodes_})),
      sums_(space_.new_vector()) {
  for (const auto node : nodes_)
    is_shared_[node] = 1;
}

double SharedNodes::square_of_sum(std::span<const double> values) const {
  double square = 0.0;
  for (std::size_t node = 0; node < is_shared_.size(); ++node)
    if (!is_shared_[node])
      for (const double value : values.subspan(node * components_, components_))
        square += value * value;
  std::vector<std::vector<double>> shared(components_);
  for (int c = 0; c < components_; ++c)
    for (const auto node : nodes_)
      shared[c].push_back(values[std::size_t(node) * components_ + c]);
  AMT_PETSC(VecSet(sums_, 0.0));
  space_.add(shared, sums_);
  const VecReader sums(sums_);
  for (PetscInt i = 0; i < sums.size(); ++i)
    square += sums[i] * sums[i];
  return square;
}

} // namespace amontons
