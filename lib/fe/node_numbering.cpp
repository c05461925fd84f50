#include "fe/node_numbering.hpp"

#include <algorithm>

namespace amontons {

namespace {

/// Scatter from a global vector with one entry a mesh node to all local nodes.
ScatterHandle node_scatter(const Mesh& mesh, Vec global, Vec local) {
  std::vector<PetscInt> globals(mesh.num_local());
  for (std::int32_t node = 0; node < mesh.num_local(); ++node)
    globals[node] = static_cast<PetscInt>(mesh.global_node(node));
  IsHandle from;
  AMT_PETSC(ISCreateGeneral(mesh.comm, mesh.num_local(), globals.data(), PETSC_COPY_VALUES, from.put()));
  ScatterHandle scatter;
  AMT_PETSC(VecScatterCreate(global, from, local, nullptr, scatter.put()));
  return scatter;
}

} // namespace

std::vector<PetscInt> rank_offsets(MPI_Comm comm, PetscInt num_owned) {
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  std::vector<PetscInt> offsets(ranks + 1, 0);
  MPI_Allgather(&num_owned, 1, MPIU_INT, offsets.data() + 1, 1, MPIU_INT, comm);
  for (int rank = 0; rank < ranks; ++rank)
    offsets[rank + 1] += offsets[rank];
  return offsets;
}

std::vector<std::vector<PetscInt>> number_node_fields(const Mesh& mesh, std::span<const NodeField> fields,
                                                      PetscInt& num_owned) {
  num_owned = 0;
  std::vector<std::vector<PetscInt>> numbers;
  if (fields.empty()) return numbers;
  VecHandle global, local;
  AMT_PETSC(VecCreateMPI(mesh.comm, mesh.num_owned, PETSC_DETERMINE, global.put()));
  AMT_PETSC(VecCreateSeq(PETSC_COMM_SELF, mesh.num_local(), local.put()));
  const auto scatter = node_scatter(mesh, global, local);
  for (const auto& field : fields) {
    std::vector<std::int32_t> owned;
    for (const auto node : field.nodes)
      if (node < mesh.num_owned) owned.push_back(node);
    std::sort(owned.begin(), owned.end());
    AMT_PETSC(VecSet(global, -1.0));
    {
      VecArray values(global);
      for (const auto node : owned)
        values[node] = static_cast<double>(num_owned++);
    }
    AMT_PETSC(VecScatterBegin(scatter, global, local, INSERT_VALUES, SCATTER_FORWARD));
    AMT_PETSC(VecScatterEnd(scatter, global, local, INSERT_VALUES, SCATTER_FORWARD));
    VecReader values(local);
    auto& number = numbers.emplace_back(mesh.num_local());
    for (std::int32_t node = 0; node < mesh.num_local(); ++node)
      number[node] = static_cast<PetscInt>(values[node]);
  }
  return numbers;
}

NodeSpace::NodeSpace(const Mesh& mesh, std::vector<NodeField> fields) : comm_(mesh.comm), fields_(std::move(fields)) {
  const auto numbers = number_node_fields(mesh, fields_, num_owned_);
  const auto offsets = rank_offsets(comm_, num_owned_);
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  std::vector<PetscInt> globals;
  for (std::size_t f = 0; f < fields_.size(); ++f)
    for (const auto node : fields_[f].nodes) {
      const int owner = node < mesh.num_owned ? rank : mesh.ghost_owners[node - mesh.num_owned];
      globals.push_back(offsets[owner] + numbers[f][node]);
    }
  const auto size = static_cast<PetscInt>(globals.size());
  IsHandle from;
  AMT_PETSC(ISCreateGeneral(comm_, size, globals.data(), PETSC_COPY_VALUES, from.put()));
  AMT_PETSC(VecCreateSeq(PETSC_COMM_SELF, size, local_.put()));
  const auto global = new_vector();
  AMT_PETSC(VecScatterCreate(global, from, local_, nullptr, scatter_.put()));
}

VecHandle NodeSpace::new_vector() const {
  VecHandle vec;
  AMT_PETSC(VecCreateMPI(comm_, num_owned_, PETSC_DETERMINE, vec.put()));
  return vec;
}

void NodeSpace::gather(Vec global, std::vector<std::vector<double>>& local) const {
  AMT_PETSC(VecScatterBegin(scatter_, global, local_, INSERT_VALUES, SCATTER_FORWARD));
  AMT_PETSC(VecScatterEnd(scatter_, global, local_, INSERT_VALUES, SCATTER_FORWARD));
  VecReader values(local_);
  local.resize(fields_.size());
  PetscInt next = 0;
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    local[f].resize(fields_[f].nodes.size());
    for (auto& value : local[f])
      value = values[next++];
  }
}

void NodeSpace::add(const std::vector<std::vector<double>>& local, Vec global) const {
  {
    VecArray values(local_);
    PetscInt next = 0;
    for (const auto& field : local)
      for (const double value : field)
        values[next++] = value;
  }
  AMT_PETSC(VecScatterBegin(scatter_, local_, global, ADD_VALUES, SCATTER_REVERSE));
  AMT_PETSC(VecScatterEnd(scatter_, local_, global, ADD_VALUES, SCATTER_REVERSE));
}

} // namespace amontons
