#include "solve/light_multigrid.hpp"

#include "solve/shell_preconditioner.hpp"

#include <memory>
#include <petsc/private/petscimpl.h> // the state of an object has no other header

namespace amontons {

namespace {

constexpr const char* factors_of_pc = "amontons_factors";

/// Blocks of this rank: with its own columns, and with those of others (null on one rank), whose global columns are
/// listed.
struct Parts {
  Mat own = nullptr, beside = nullptr;
  const PetscInt* columns = nullptr;
};

Parts parts_of(Mat matrix) {
  Parts parts{matrix};
  PetscBool is_distributed = PETSC_FALSE;
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATMPIAIJ, &is_distributed));
  if (is_distributed) AMT_PETSC(MatMPIAIJGetSeqAIJ(matrix, &parts.own, &parts.beside, &parts.columns));
  return parts;
}

int block_size(Mat matrix) {
  PetscInt size = 1;
  AMT_PETSC(MatGetBlockSize(matrix, &size));
  return static_cast<int>(size);
}

/// What the PC `icc_single` holds.
struct Factors {
  PetscObjectState pattern = 0;
  std::optional<SinglePrecisionFactors> factors;
};

Factors& factors_of(PC pc) {
  PetscObject container = nullptr;
  void* held = nullptr;
  AMT_PETSC(PetscObjectQuery(reinterpret_cast<PetscObject>(pc), factors_of_pc, &container));
  AMT_PETSC(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &held));
  return *static_cast<Factors*>(held);
}

PetscErrorCode destroy_factors(void* held) {
  delete static_cast<Factors*>(held);
  return 0;
}

PetscErrorCode set_up_factors(PC pc) {
  std::exception_ptr known_by_its_code;
  return guarded(known_by_its_code, [&] {
    Factors& held = factors_of(pc);
    Mat matrix = nullptr;
    PetscObjectState pattern = 0;
    AMT_PETSC(PCGetOperators(pc, nullptr, &matrix));
    const Mat own = parts_of(matrix).own;
    AMT_PETSC(MatGetNonzeroState(own, &pattern));
    if (!held.factors || pattern != held.pattern) held.factors.emplace(own, block_size(matrix));
    held.pattern = pattern;
    int failed = !held.factors->factorize(own); // on any rank: the others would go on without it
    MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, PetscObjectComm(reinterpret_cast<PetscObject>(pc)));
    if (failed) AMT_PETSC(PCSetFailedReason(pc, PC_FACTOR_NUMERIC_ZEROPIVOT));
  });
}

PetscErrorCode apply_factors(PC pc, Vec in, Vec out) {
  std::exception_ptr known_by_its_code;
  return guarded(known_by_its_code, [&] {
    const VecReader from(in);
    VecArray to(out);
    factors_of(pc).factors->solve(from.data(), to.data());
  });
}

/// A PCSHELL by another name, so that options can choose it; by that name it does not give its context, so that is
/// composed with it.
PetscErrorCode create_factors(PC pc) {
  std::exception_ptr known_by_its_code;
  return guarded(known_by_its_code, [&] {
    Handle<PetscContainer, PetscContainerDestroy> container;
    AMT_PETSC(PCSetType(pc, PCSHELL));
    AMT_PETSC(PetscContainerCreate(PetscObjectComm(reinterpret_cast<PetscObject>(pc)), container.put()));
    AMT_PETSC(PetscContainerSetPointer(container, std::make_unique<Factors>().release()));
    AMT_PETSC(PetscContainerSetUserDestroy(container, destroy_factors));
    AMT_PETSC(PetscObjectCompose(reinterpret_cast<PetscObject>(pc), factors_of_pc,
                                 reinterpret_cast<PetscObject>(container.get())));
    AMT_PETSC(PCShellSetSetUp(pc, set_up_factors));
    AMT_PETSC(PCShellSetApply(pc, apply_factors));
  });
}

} // namespace

void register_icc_single() { AMT_PETSC(PCRegister(pc_icc_single, create_factors)); }

SinglePrecisionProduct::SinglePrecisionProduct(Mat matrix) : matrix_(matrix) {
  PetscInt rows = 0, columns = 0;
  AMT_PETSC(MatGetLocalSize(matrix, &rows, &columns));
  AMT_PETSC(MatCreateShell(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), rows, columns, PETSC_DETERMINE,
                           PETSC_DETERMINE, this, shell_.put()));
  AMT_PETSC(MatShellSetOperation(shell_, MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
  AMT_PETSC(MatGetNonzeroState(matrix, &pattern_));
  AMT_PETSC(PetscObjectStateGet(reinterpret_cast<PetscObject>(matrix), &state_));
  const Parts parts = parts_of(matrix);
  own_.emplace(parts.own, block_size(matrix));
  if (!parts.beside) return;
  PetscInt count = 0;
  IsHandle wanted;
  VecHandle whole;
  beside_.emplace(parts.beside, block_size(matrix));
  AMT_PETSC(MatGetLocalSize(parts.beside, nullptr, &count));
  AMT_PETSC(ISCreateGeneral(PETSC_COMM_SELF, count, parts.columns, PETSC_COPY_VALUES, wanted.put()));
  AMT_PETSC(VecCreateSeq(PETSC_COMM_SELF, count, ghosts_.put()));
  AMT_PETSC(MatCreateVecs(matrix, whole.put(), nullptr));
  AMT_PETSC(VecScatterCreate(whole, wanted, ghosts_, nullptr, scatter_.put()));
}

bool SinglePrecisionProduct::is_outdated() const {
  PetscObjectState pattern = 0;
  AMT_PETSC(MatGetNonzeroState(matrix_, &pattern));
  return pattern != pattern_;
}

bool SinglePrecisionProduct::update() {
  PetscObjectState state = 0;
  AMT_PETSC(PetscObjectStateGet(reinterpret_cast<PetscObject>(matrix_), &state));
  if (state == state_) return false;
  const Parts parts = parts_of(matrix_);
  own_->copy_numbers(parts.own);
  if (beside_) beside_->copy_numbers(parts.beside);
  state_ = state;
  AMT_PETSC(PetscObjectStateIncrease(reinterpret_cast<PetscObject>(shell_.get())));
  return true;
}

PetscErrorCode SinglePrecisionProduct::multiply(Mat shell, Vec x, Vec y) {
  std::exception_ptr known_by_its_code;
  return guarded(known_by_its_code, [&] {
    void* self = nullptr;
    AMT_PETSC(MatShellGetContext(shell, &self));
    const auto& product = *static_cast<const SinglePrecisionProduct*>(self);
    if (product.beside_)
      AMT_PETSC(VecScatterBegin(product.scatter_, x, product.ghosts_, INSERT_VALUES, SCATTER_FORWARD));
    const VecReader from(x);
    VecArray to(y);
    product.own_->multiply(from.data(), to.data());
    if (!product.beside_) return;
    AMT_PETSC(VecScatterEnd(product.scatter_, x, product.ghosts_, INSERT_VALUES, SCATTER_FORWARD));
    product.beside_->multiply_add(VecReader(product.ghosts_).data(), to.data());
  });
}

bool LightMultigrid::applies_to(KSP solver) {
  PC pc = nullptr;
  Mat matrix = nullptr;
  PetscBool is_aggregation = PETSC_FALSE, is_aij = PETSC_FALSE;
  AMT_PETSC(KSPGetPC(solver, &pc));
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCGAMG, &is_aggregation));
  AMT_PETSC(KSPGetOperators(solver, nullptr, &matrix));
  AMT_PETSC(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(matrix), &is_aij, MATSEQAIJ, MATMPIAIJ, ""));
  return is_aggregation && is_aij;
}

LightMultigrid::LightMultigrid(KSP solver)
    : type_(take_place_of_preconditioner(solver, "light_", this, set_up, apply)) {}

PetscErrorCode LightMultigrid::set_up(PC pc) {
  return with_context<LightMultigrid>(pc, [&](LightMultigrid& self) { self.rebuild(pc); });
}

void LightMultigrid::rebuild(PC outer) {
  Mat matrix = nullptr;
  PCFailedReason failure = PC_NOERROR;
  AMT_PETSC(PCGetOperators(outer, nullptr, &matrix));
  if (inner_) AMT_PETSC(PCGetFailedReason(inner_, &failure));
  if (!inner_ || failure != PC_NOERROR) {
    AMT_PETSC(PCCreate(PetscObjectComm(reinterpret_cast<PetscObject>(outer)), inner_.put()));
    AMT_PETSC(PCSetType(inner_, type_.c_str()));
    AMT_PETSC(PCSetOperators(inner_, matrix, matrix));
    AMT_PETSC(PCSetFromOptions(inner_));
  }
  AMT_PETSC(PCSetOperators(inner_, matrix, matrix));
  AMT_PETSC(PCSetReusePreconditioner(inner_, PETSC_FALSE));
  AMT_PETSC(PCSetUp(inner_));
  AMT_PETSC(PCSetReusePreconditioner(inner_, PETSC_TRUE)); // until the outer one is to be set up again
  AMT_PETSC(PCGetFailedReason(inner_, &failure));
  AMT_PETSC(PCSetFailedReason(outer, failure));
  matrix_ = matrix;
  lighten();
}

KSP LightMultigrid::smoother() {
  PetscInt levels = 0;
  KSP smoother = nullptr;
  AMT_PETSC(PCMGGetLevels(inner_, &levels));
  if (levels > 1) AMT_PETSC(PCMGGetSmoother(inner_, levels - 1, &smoother));
  return smoother;
}

/// The finest level's products, where Chebyshev's method and the cycle ask for them.
void LightMultigrid::lighten() {
  PetscInt levels = 0;
  const KSP finest = smoother();
  if (!finest) {
    product_.reset();
    return;
  }
  if (!product_ || product_->is_outdated())
    product_.emplace(matrix_);
  else
    product_->update();
  AMT_PETSC(PCMGGetLevels(inner_, &levels));
  AMT_PETSC(KSPSetOperators(finest, *product_, matrix_));
  AMT_PETSC(PCMGSetResidual(inner_, levels - 1, PCMGResidualDefault, *product_));
}

/// A hierarchy that is kept smooths with the tangent of the time, within the bounds of eigenvalues that it was set up
/// with, as PETSc's own would.
void LightMultigrid::follow_tangent() {
  if (!product_) return;
  if (product_->is_outdated()) {
    lighten();
  } else if (product_->update()) {
    PC pc = nullptr;
    AMT_PETSC(KSPGetPC(smoother(), &pc));
    AMT_PETSC(PCSetUp(pc));
  }
}

PetscErrorCode LightMultigrid::apply(PC pc, Vec in, Vec out) {
  return with_context<LightMultigrid>(pc, [&](LightMultigrid& self) {
    self.follow_tangent();
    AMT_PETSC(PCApply(self.inner_, in, out));
  });
}

} // namespace amontons
