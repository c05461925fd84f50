#include "mesh/partitioner.hpp"

#include <algorithm>
#include <metis.h>
#include <numeric>
#include <petsc/private/partitionerimpl.h>

namespace amontons {
namespace {

constexpr const char* type_name = "metis";

/// An edge across an interface counts as much as this many between neighbours: cutting along it does not pay.
constexpr idx_t strong_edge = 20;

struct Graph {
  std::vector<idx_t> offsets, neighbours, edge_weights;
};

/// The graph of neighbours with the strong pairs added in both directions.
Graph weighted_graph(PetscInt num_cells, const PetscInt start[], const PetscInt adjacency[],
                     const std::vector<std::array<std::int64_t, 2>>& pairs) {
  std::vector<std::array<std::int64_t, 2>> both;
  for (const auto& [a, b] : pairs)
    if (a != b) both.insert(both.end(), {{a, b}, {b, a}});
  std::sort(both.begin(), both.end());
  both.erase(std::unique(both.begin(), both.end()), both.end());
  Graph graph;
  graph.offsets.push_back(0);
  auto extra = both.begin();
  for (PetscInt cell = 0; cell < num_cells; ++cell) {
    graph.neighbours.insert(graph.neighbours.end(), adjacency + start[cell], adjacency + start[cell + 1]);
    graph.edge_weights.resize(graph.neighbours.size(), 1);
    for (; extra != both.end() && (*extra)[0] == cell; ++extra) {
      const auto own = graph.neighbours.begin() + graph.offsets.back();
      const auto known = std::find(own, graph.neighbours.end(), static_cast<idx_t>((*extra)[1]));
      if (known != graph.neighbours.end()) {
        graph.edge_weights[known - graph.neighbours.begin()] = strong_edge;
        continue;
      }
      graph.neighbours.push_back(static_cast<idx_t>((*extra)[1]));
      graph.edge_weights.push_back(strong_edge);
    }
    graph.offsets.push_back(static_cast<idx_t>(graph.neighbours.size()));
  }
  return graph;
}

/// The part of each cell. Recursive bisection gives better cuts for few parts, k-way is faster for many.
std::vector<idx_t> metis_parts(Graph& graph, const std::vector<std::int32_t>& cell_weights, idx_t num_parts) {
  idx_t num_cells = static_cast<idx_t>(graph.offsets.size()) - 1, constraints = 1, cut = 0;
  std::vector<idx_t> parts(num_cells, 0);
  if (num_cells <= num_parts) { // METIS may fail here
    std::iota(parts.begin(), parts.end(), 0);
    return parts;
  }
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  std::vector<idx_t> weights(cell_weights.begin(), cell_weights.end());
  const auto partition = num_parts <= 8 ? METIS_PartGraphRecursive : METIS_PartGraphKway;
  const int status = partition(&num_cells, &constraints, graph.offsets.data(), graph.neighbours.data(),
                               weights.empty() ? nullptr : weights.data(), nullptr, graph.edge_weights.data(),
                               &num_parts, nullptr, nullptr, options, &cut, parts.data());
  if (status != METIS_OK) parts.clear();
  return parts;
}

PetscErrorCode partition(PetscPartitioner partitioner, PetscInt num_parts, PetscInt num_cells, PetscInt start[],
                         PetscInt adjacency[], PetscSection, PetscSection, PetscSection part_section, IS* points) {
  PetscFunctionBegin;
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(partitioner));
  PetscMPIInt rank;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCheck(rank == 0 || num_cells == 0, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "metis needs the whole mesh on rank 0; use -petscpartitioner_type ptscotch");
  const auto& hints = *static_cast<PartitionHints*>(partitioner->data);
  std::vector<PetscInt> order(num_cells);
  if (num_cells > 0) {
    auto graph = weighted_graph(num_cells, start, adjacency, hints.strong_pairs);
    const auto parts = metis_parts(graph, hints.cell_weights, static_cast<idx_t>(num_parts));
    PetscCheck(!parts.empty(), PETSC_COMM_SELF, PETSC_ERR_LIB, "METIS failed");
    for (const auto part : parts)
      PetscCall(PetscSectionAddDof(part_section, part, 1));
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](PetscInt a, PetscInt b) { return parts[a] < parts[b]; });
  }
  PetscCall(ISCreateGeneral(comm, num_cells, order.data(), PETSC_COPY_VALUES, points));
  PetscFunctionReturn(0);
}

PetscErrorCode destroy(PetscPartitioner partitioner) {
  delete static_cast<PartitionHints*>(partitioner->data);
  partitioner->data = nullptr;
  return 0;
}

PetscErrorCode create(PetscPartitioner partitioner) {
  partitioner->data = new PartitionHints;
  partitioner->noGraph = PETSC_FALSE;
  partitioner->ops->partition = partition;
  partitioner->ops->destroy = destroy;
  return 0;
}

} // namespace

void register_metis_partitioner() {
  static bool done = false;
  if (!done) AMT_PETSC(PetscPartitionerRegister(type_name, create));
  done = true;
}

void set_partition_hints(PetscPartitioner partitioner, PartitionHints hints) {
  PetscBool is_ours = PETSC_FALSE;
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(partitioner), type_name, &is_ours));
  if (is_ours) *static_cast<PartitionHints*>(partitioner->data) = std::move(hints);
}

} // namespace amontons
