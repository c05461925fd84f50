#include "fe/dof_layout.hpp"

#include <algorithm>
#include <limits>

namespace amontons {

namespace {

/// Index of the rank whose range [offsets[r], offsets[r + 1]) holds `number`.
int owner_of(const std::vector<PetscInt>& offsets, PetscInt number) {
  return static_cast<int>(std::upper_bound(offsets.begin(), offsets.end(), number) - offsets.begin()) - 1;
}

} // namespace

DofLayout::DofLayout(const Mesh& mesh, std::vector<TiedGroup> tied, std::span<const NodeField> extra)
    : mesh_(&mesh), tied_(std::move(tied)) {
  const int d = mesh.dim;
  MPI_Comm_rank(mesh.comm, &rank_);
  PetscInt extra_owned = 0;
  extra_ = number_node_fields(mesh, extra, extra_owned);

  num_owned_ = mesh.num_owned * d + extra_owned;
  node_offsets_ = rank_offsets(mesh.comm, mesh.num_owned);
  equation_offsets_ = rank_offsets(mesh.comm, num_owned_);
  block_offsets_ = rank_offsets(mesh.comm, mesh.num_owned + extra_owned);
  first_equation_ = equation_offsets_[rank_];
  num_global_ = equation_offsets_.back();
  num_extra_global_ = num_global_ - node_offsets_.back() * d;

  const auto owner = [&](std::int32_t node) {
    return node < mesh.num_owned ? rank_ : mesh.ghost_owners[node - mesh.num_owned];
  };
  equations_.resize(std::size_t(mesh.num_local()) * d);
  for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
    const auto in_owner = static_cast<PetscInt>(mesh.global_node(node)) - node_offsets_[owner(node)];
    for (int c = 0; c < d; ++c)
      equations_[std::size_t(node) * d + c] = equation_offsets_[owner(node)] + in_owner * d + c;
  }
  for (auto& field : extra_)
    for (std::int32_t node = 0; node < mesh.num_local(); ++node)
      if (field[node] >= 0) {
        const PetscInt nodes_of_owner = node_offsets_[owner(node) + 1] - node_offsets_[owner(node)];
        field[node] += equation_offsets_[owner(node)] + nodes_of_owner * d;
      }

  for (const auto& [group, component] : tied_) {
    // The lowest equation of the group speaks for all of it.
    PetscInt lowest = std::numeric_limits<PetscInt>::max();
    for (const auto node : mesh.node_groups.at(group))
      lowest = std::min(lowest, equation(node, component));
    MPI_Allreduce(MPI_IN_PLACE, &lowest, 1, MPIU_INT, MPI_MIN, mesh.comm);
    tied_equations_.push_back(lowest);
    for (const auto node : mesh.node_groups.at(group)) {
      auto& number = equations_[std::size_t(node) * d + component];
      if (node < mesh.num_owned && number != lowest) idle_.push_back(number);
      number = lowest;
    }
  }

  const auto size = static_cast<PetscInt>(equations_.size());
  IsHandle from;
  AMT_PETSC(ISCreateGeneral(mesh.comm, size, equations_.data(), PETSC_COPY_VALUES, from.put()));
  AMT_PETSC(VecCreateSeq(PETSC_COMM_SELF, size, local_.put()));
  const auto global = new_vector();
  AMT_PETSC(VecScatterCreate(global, from, local_, nullptr, scatter_.put()));
}

PetscInt DofLayout::block_of(PetscInt equation) const {
  const int owner = owner_of(equation_offsets_, equation);
  const PetscInt in_owner = equation - equation_offsets_[owner];
  const PetscInt nodes = node_offsets_[owner + 1] - node_offsets_[owner];
  const PetscInt block = in_owner < nodes * dim() ? in_owner / dim() : nodes + (in_owner - nodes * dim());
  return block_offsets_[owner] + block;
}

PetscInt DofLayout::block_begin(PetscInt block) const {
  const int owner = block_owner(block);
  const PetscInt in_owner = block - block_offsets_[owner];
  const PetscInt nodes = node_offsets_[owner + 1] - node_offsets_[owner];
  const PetscInt begin = in_owner < nodes ? in_owner * dim() : nodes * dim() + (in_owner - nodes);
  return equation_offsets_[owner] + begin;
}

PetscInt DofLayout::block_size(PetscInt block) const {
  const int owner = block_owner(block);
  const PetscInt nodes = node_offsets_[owner + 1] - node_offsets_[owner];
  return block - block_offsets_[owner] < nodes ? dim() : 1;
}

int DofLayout::block_owner(PetscInt block) const { return owner_of(block_offsets_, block); }

VecHandle DofLayout::new_vector() const {
  VecHandle vec;
  AMT_PETSC(VecCreateMPI(mesh_->comm, num_owned_, PETSC_DETERMINE, vec.put()));
  if (num_extra_global_ == 0) AMT_PETSC(VecSetBlockSize(vec, dim()));
  return vec;
}

void DofLayout::gather_displacement(Vec global, std::span<double> local) const {
  AMT_PETSC(VecScatterBegin(scatter_, global, local_, INSERT_VALUES, SCATTER_FORWARD));
  AMT_PETSC(VecScatterEnd(scatter_, global, local_, INSERT_VALUES, SCATTER_FORWARD));
  VecReader values(local_);
  std::copy(values.data(), values.data() + values.size(), local.begin());
}

void DofLayout::put_displacement(std::span<const double> local, Vec global) const {
  VecArray values(global);
  for (std::size_t i = 0; i < local.size(); ++i) {
    const PetscInt owned = equations_[i] - first_equation_;
    if (owned >= 0 && owned < num_owned_) values[owned] = local[i];
  }
}

void DofLayout::add_forces(std::span<const double> local, Vec global) const { bring(local, global, ADD_VALUES); }

void DofLayout::take_largest(std::span<const double> local, Vec global) const { bring(local, global, MAX_VALUES); }

void DofLayout::bring(std::span<const double> local, Vec global, InsertMode how) const {
  {
    VecArray values(local_);
    std::copy(local.begin(), local.end(), values.data());
  }
  AMT_PETSC(VecScatterBegin(scatter_, local_, global, how, SCATTER_REVERSE));
  AMT_PETSC(VecScatterEnd(scatter_, local_, global, how, SCATTER_REVERSE));
}

} // namespace amontons
