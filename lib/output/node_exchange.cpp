#include "output/node_exchange.hpp"

#include <algorithm>

namespace amontons {

namespace {

/// The owned and ghost entries of a ghosted vector for the life of the scope.
class LocalForm {
 public:
  explicit LocalForm(Vec vec) : vec_(vec) {
    AMT_PETSC(VecGhostGetLocalForm(vec_, &local_));
    AMT_PETSC(VecGetArray(local_, &data_));
  }
  ~LocalForm() {
    VecRestoreArray(local_, &data_);
    VecGhostRestoreLocalForm(vec_, &local_);
  }
  LocalForm(const LocalForm&) = delete;
  LocalForm& operator=(const LocalForm&) = delete;
  double* data() { return data_; }

 private:
  Vec vec_;
  Vec local_ = nullptr;
  double* data_ = nullptr;
};

} // namespace

NodeExchange::NodeExchange(const Mesh& mesh) {
  const std::vector<PetscInt> ghosts(mesh.ghost_globals.begin(), mesh.ghost_globals.end());
  AMT_PETSC(VecCreateGhost(mesh.comm, mesh.num_owned, PETSC_DECIDE, static_cast<PetscInt>(ghosts.size()), ghosts.data(),
                           vec_.put()));
}

void NodeExchange::load(std::span<const double> local) {
  LocalForm form(vec_);
  std::copy(local.begin(), local.end(), form.data());
}

void NodeExchange::unload(std::span<double> local) const {
  LocalForm form(vec_);
  std::copy_n(form.data(), local.size(), local.begin());
}

void NodeExchange::to_ghosts(std::span<double> local) {
  load(local);
  AMT_PETSC(VecGhostUpdateBegin(vec_, INSERT_VALUES, SCATTER_FORWARD));
  AMT_PETSC(VecGhostUpdateEnd(vec_, INSERT_VALUES, SCATTER_FORWARD));
  unload(local);
}

void NodeExchange::largest_to_owners(std::span<double> local) {
  load(local);
  AMT_PETSC(VecGhostUpdateBegin(vec_, MAX_VALUES, SCATTER_REVERSE));
  AMT_PETSC(VecGhostUpdateEnd(vec_, MAX_VALUES, SCATTER_REVERSE));
  unload(local);
}

} // namespace amontons
