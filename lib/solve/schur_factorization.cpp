// With I the equations outside B, a tangent is
//   [J_II J_IB; J_BI J_BB],  and J_II, J_IB and J_BI are the same in all tangents of one pattern:
// they belong to the solid, are symmetric, and stay so under friction. MUMPS, asked for the Schur complement of B,
// makes S = J_BB − J_BI J_II⁻¹ J_IB of the first tangent and factorizes J_II. A later tangent has S + (J_BB − J_BB of
// the first), and a solve is a forward substitution with J_II, a dense system, a backward substitution.
//
// Partial steps. J_II, J_IB and J_BI are constant because the equations I are linear in all unknowns, and B sees x_I
// linearly. So once the residual F_I is none, at x⁰, it stays none if x_I always follows x_B,
//   x_I = x⁰_I + J_II⁻¹ J_IB a,   a = x⁰_B − x_B,
// and Newton's method need not know x_I at all. It goes on with x_I = x⁰_I as if x_I had followed: there the residual
// is
//   F_I + J_IB a = 0,   F_B + J_BI J_II⁻¹ J_IB a = F_B + (J_BB − S) a
// (all of the first tangent), and the step of B is (S + J_BB − J_BB of the first)⁻¹ times that: dense systems only. At
// the end one solve with J_II lets x_I follow. Iterates of B, residuals and steps are the same as those of whole steps.
#include "solve/schur_factorization.hpp"

#include "base/timer.hpp"

#include <algorithm>

namespace amontons {

namespace {

/// A solve that leaves more than this of its right-hand side is improved once, and then done without condensation.
constexpr double exactness = 1e-10;
/// Rows of the pattern by which equations that change are widened, so that a zone of contact can grow a little.
constexpr int margin = 2;
/// Two or three dense matrices of so many equations, 72 MB each, are kept.
constexpr std::size_t most_equations = 3'000;

/// Calls visit(columns, values) with a row of the matrix.
template <class Visit>
void visit_row(Mat matrix, PetscInt row, const Visit& visit) {
  PetscInt count = 0;
  const PetscInt* columns = nullptr;
  const double* values = nullptr;
  AMT_PETSC(MatGetRow(matrix, row, &count, &columns, &values));
  visit(std::span(columns, static_cast<std::size_t>(count)), std::span(values, static_cast<std::size_t>(count)));
  AMT_PETSC(MatRestoreRow(matrix, row, &count, &columns, &values));
}

} // namespace

bool can_condense(const Problem& problem) {
  int ranks = 1;
  MPI_Comm_size(problem.comm(), &ranks);
  if (ranks > 1) return false;
  const auto size = problem.changing_equations().size();
  return size > 0 && size <= most_equations && size < static_cast<std::size_t>(problem.layout().num_global());
}

SchurFactorization::SchurFactorization(const Problem& problem, SNES snes)
    : TangentSolver(problem, snes), correction_(problem.layout().new_vector()) {}

bool SchurFactorization::solve(Vec right, Vec solution) {
  Vec unknowns = nullptr;
  AMT_PETSC(SNESGetSolution(snes_, &unknowns));
  // With the factor of the old pattern. The residual stays what it is, for it is already that of the state put right.
  if (problem_.pattern_number() != pattern_number_) put_right(unknowns);
  if (factorized_tangent_ != tangent_ && !factorize()) return false;
  if (solve_partly(right, solution)) return true;
  put_right(unknowns);
  return solve_whole(right, solution);
}

bool SchurFactorization::solve_whole(Vec right, Vec solution) {
  AMT_PETSC(MatSolve(way_ == Way::Condensed ? constant_.get() : whole_.get(), right, solution));
  if (way_ == Way::Plain) return true;
  PetscReal norm = 0.0;
  AMT_PETSC(VecNorm(right, NORM_2, &norm));
  const double wanted = std::max(exactness * norm, smallest_residual());
  bool is_exact = measure_defect(right, solution) <= wanted;
  if (!is_exact) {
    AMT_PETSC(MatSolve(constant_.get(), defect(), correction_));
    AMT_PETSC(VecAXPY(solution, 1.0, correction_));
    is_exact = measure_defect(right, solution) <= wanted;
  }
  if (is_exact) {
    if (steps_ == Steps::WholeAtFirst) steps_ = Steps::Partial;
    return true;
  }
  if (steps_ == Steps::Partial) steps_ = Steps::WholeAtFirst;
  if (!factorize_whole()) return false;
  AMT_PETSC(MatSolve(whole_.get(), right, solution));
  return true;
}

/// The step of B alone; false if it must be a whole one: because none of this Newton solve has shown yet that the
/// constant part is what it was, because the other equations have a residual, or because the step is not exact.
bool SchurFactorization::solve_partly(Vec right, Vec solution) {
  if (steps_ != Steps::Partial || way_ != Way::Condensed) return false;
  Vec unknowns = nullptr;
  PetscReal norm = 0.0, others = 0.0;
  AMT_PETSC(SNESGetSolution(snes_, &unknowns));
  if (rest_.empty()) negligible_ = smallest_residual(); // the forces are those of x_I now, and are not later
  auto step = in_block(right);
  AMT_PETSC(VecCopy(right, defect()));
  put_in_block(std::vector<double>(step.size(), 0.0), defect());
  AMT_PETSC(VecNorm(defect(), NORM_2, &others));
  if (others > negligible_) return false;

  block_->solve(step);
  AMT_PETSC(VecSet(solution, 0.0));
  put_in_block(step, solution);
  AMT_PETSC(VecNorm(right, NORM_2, &norm));
  measure_defect(right, solution);
  add_condensed(step, defect());
  PetscReal left = 0.0;
  AMT_PETSC(VecNorm(defect(), NORM_2, &left));
  if (left > std::max(exactness * norm, negligible_)) return false;
  if (rest_.empty()) rest_ = in_block(unknowns);
  return true;
}

void SchurFactorization::allow_partial_steps() {
  steps_ = Steps::WholeAtFirst;
  rest_.clear();
}

void SchurFactorization::add_left_out(Vec unknowns, Vec residual) {
  if (!rest_.empty()) add_condensed(distance_to_rest(unknowns), residual);
}

bool SchurFactorization::complete(Vec unknowns) {
  steps_ = Steps::Whole;
  const bool is_partial = !rest_.empty();
  put_right(unknowns);
  return is_partial;
}

/// Lets x_I follow x_B.
void SchurFactorization::put_right(Vec unknowns) {
  if (rest_.empty()) return;
  const auto distance = distance_to_rest(unknowns);
  AMT_PETSC(VecSet(defect(), 0.0));
  add_condensed(distance, defect());
  put_in_block(std::vector<double>(distance.size(), 0.0), defect());
  holds_block_ = true;
  AMT_PETSC(MatSolve(constant_.get(), defect(), correction_));
  holds_block_ = false;
  AMT_PETSC(VecAXPY(unknowns, 1.0, correction_));
  rest_.clear();
}

/// Adds (J_IB a, (J_BB − S) a) of the first tangent, a = `block`.
void SchurFactorization::add_condensed(std::span<const double> block, Vec residual) const {
  VecHandle part;
  AMT_PETSC(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(block.size()), block.data(), part.put()));
  AMT_PETSC(MatMultAdd(coupling_, part, residual, residual));
  const auto condensed = block_->times_reference(block);
  VecArray values(residual);
  for (std::size_t i = 0; i < condensed.size(); ++i)
    values[equations_[i]] -= condensed[i];
}

std::vector<double> SchurFactorization::in_block(Vec vector) const {
  const VecReader values(vector);
  std::vector<double> block(equations_.size());
  for (std::size_t i = 0; i < block.size(); ++i)
    block[i] = values[equations_[i]];
  return block;
}

void SchurFactorization::put_in_block(std::span<const double> block, Vec vector) const {
  VecArray values(vector);
  for (std::size_t i = 0; i < block.size(); ++i)
    values[equations_[i]] = block[i];
}

/// a.
std::vector<double> SchurFactorization::distance_to_rest(Vec unknowns) const {
  auto distance = in_block(unknowns);
  for (std::size_t i = 0; i < distance.size(); ++i)
    distance[i] = rest_[i] - distance[i];
  return distance;
}

/// The tangent in the matrix, condensed where that can be; false if it is singular.
bool SchurFactorization::factorize() {
  if (problem_.pattern_number() != pattern_number_) {
    pattern_number_ = problem_.pattern_number();
    block_.reset();
    constant_.forget();
    if (can_condense(problem_) && !eliminate_constant()) block_.reset();
  }
  if (!block_ || !condense()) return factorize_whole();
  whole_.forget();
  factorized_tangent_ = tangent_;
  way_ = Way::Condensed;
  return true;
}

bool SchurFactorization::factorize_whole() {
  PetscObjectState pattern = 0;
  AMT_PETSC(MatGetNonzeroState(matrix_, &pattern));
  ++factorizations_;
  factorized_tangent_ = none;
  const auto kind = problem_.tangent_is_symmetric() ? MumpsFactor::Kind::Symmetric : MumpsFactor::Kind::Unsymmetric;
  if (!whole_.factorize(matrix_, pattern, kind)) return false;
  factorized_tangent_ = tangent_;
  way_ = Way::Plain;
  return true;
}

/// Once for a pattern: makes the present tangent the reference. False if J_II is singular.
bool SchurFactorization::eliminate_constant() {
  equations_ = problem_.changing_equations();
  const auto size = static_cast<PetscInt>(equations_.size());
  position_.assign(problem_.layout().num_global(), -1);
  for (PetscInt i = 0; i < size; ++i)
    position_[equations_[i]] = i;
  reference_.clear();
  for (const PetscInt row : equations_)
    visit_row(matrix_, row,
              [this](auto, auto values) { reference_.insert(reference_.end(), values.begin(), values.end()); });

  IsHandle kept, all;
  AMT_PETSC(ISCreateGeneral(PETSC_COMM_SELF, size, equations_.data(), PETSC_COPY_VALUES, kept.put()));
  AMT_PETSC(ISCreateStride(PETSC_COMM_SELF, problem_.layout().num_owned(), 0, 1, all.put()));
  AMT_PETSC(MatCreateSubMatrix(matrix_, all, kept, MAT_INITIAL_MATRIX, coupling_.put()));
  MatHandle part;
  if (!problem_.tangent_is_symmetric()) part = symmetric_part(matrix_);
  const Mat source = part ? part.get() : matrix_;
  PetscObjectState pattern = 0;
  AMT_PETSC(MatGetNonzeroState(matrix_, &pattern));
  ++factorizations_;
  if (!constant_.factorize(source, pattern, MumpsFactor::Kind::Symmetric, kept)) return false;

  Mat schur = nullptr;
  MatFactorSchurStatus status = MAT_FACTOR_SCHUR_UNFACTORED;
  AMT_PETSC(MatFactorGetSchurComplement(constant_.get(), &schur, &status));
  fill_reference(schur, source);
  const double* values = nullptr;
  AMT_PETSC(MatDenseGetArrayRead(schur, &values));
  block_.emplace(std::span(values, std::size_t(size) * size), size); // as long as the factor lives
  AMT_PETSC(MatDenseRestoreArrayRead(schur, &values));
  // PETSc solves with this matrix between the two substitutions: that is left to the block.
  PetscContainer context = nullptr;
  AMT_PETSC(PetscContainerCreate(PETSC_COMM_SELF, &context));
  AMT_PETSC(PetscContainerSetPointer(context, this));
  AMT_PETSC(PetscObjectCompose(reinterpret_cast<PetscObject>(schur), "block", reinterpret_cast<PetscObject>(context)));
  AMT_PETSC(PetscContainerDestroy(&context));
  AMT_PETSC(MatSetOperation(schur, MATOP_MAT_SOLVE, reinterpret_cast<void (*)()>(solve_block)));
  AMT_PETSC(MatSetFactorType(schur, MAT_FACTOR_LU));
  AMT_PETSC(MatFactorRestoreSchurComplement(constant_.get(), &schur, MAT_FACTOR_SCHUR_FACTORED));
  return true;
}

/// MUMPS gives the lower triangle, and that of a symmetric matrix; what was left out of the tangent for that is put
/// back.
void SchurFactorization::fill_reference(Mat schur, Mat eliminated) {
  const std::size_t size = equations_.size();
  double* entries = nullptr;
  AMT_PETSC(MatDenseGetArray(schur, &entries));
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = j + 1; i < size; ++i)
      entries[i * size + j] = entries[j * size + i];
  if (eliminated != matrix_)
    for (const double sign : {1.0, -1.0})
      for (std::size_t i = 0; i < size; ++i)
        visit_row(sign > 0.0 ? matrix_ : eliminated, equations_[i], [&](auto columns, auto values) {
          for (std::size_t k = 0; k < columns.size(); ++k)
            if (const int j = position_[columns[k]]; j >= 0) entries[j * size + i] += sign * values[k];
        });
  AMT_PETSC(MatDenseRestoreArray(schur, &entries));
}

std::vector<ChangingBlock::Change> SchurFactorization::find_changes() const {
  std::vector<ChangingBlock::Change> changes;
  auto known = reference_.begin();
  for (int i = 0; i < block_->size(); ++i)
    visit_row(matrix_, equations_[i], [&](auto columns, auto values) {
      for (std::size_t k = 0; k < columns.size(); ++k, ++known)
        if (values[k] != *known) changes.push_back({i, position_[columns[k]], values[k] - *known});
    });
  return changes;
}

/// The rows and columns of changes, what changed before, and a margin.
std::vector<int> SchurFactorization::widened(std::span<const ChangingBlock::Change> changes) const {
  std::vector<std::uint8_t> marked(block_->size(), 0);
  for (const auto& change : changes)
    marked[change.row] = marked[change.column] = 1;
  for (int layer = 0; layer < margin; ++layer) {
    const auto before = marked;
    for (int i = 0; i < block_->size(); ++i)
      if (before[i])
        visit_row(matrix_, equations_[i], [&](auto columns, auto) {
          for (const PetscInt column : columns)
            if (position_[column] >= 0) marked[position_[column]] = 1;
        });
  }
  for (const int i : block_->changing())
    marked[i] = 1;
  std::vector<int> all;
  for (int i = 0; i < block_->size(); ++i)
    if (marked[i]) all.push_back(i);
  return all;
}

/// The present tangent as a change of the reference; false if something is singular.
bool SchurFactorization::condense() {
  const Phase phase("factorization");
  const auto changes = find_changes();
  if (!block_->covers(changes) && !block_->set_changing(widened(changes))) return false;
  return block_->factorize(changes);
}

/// PETSc's MatMatSolve on the Schur complement.
PetscErrorCode SchurFactorization::solve_block(Mat schur, Mat right, Mat solution) {
  PetscContainer context = nullptr;
  void* self = nullptr;
  PetscInt columns = 0;
  PetscCall(PetscObjectQuery(reinterpret_cast<PetscObject>(schur), "block", reinterpret_cast<PetscObject*>(&context)));
  PetscCall(PetscContainerGetPointer(context, &self));
  auto& factorization = *static_cast<SchurFactorization*>(self);
  const std::size_t size = factorization.equations_.size();
  PetscCall(MatCopy(right, solution, SAME_NONZERO_PATTERN));
  PetscCall(MatGetSize(solution, nullptr, &columns));
  double* values = nullptr;
  PetscCall(MatDenseGetArray(solution, &values));
  PetscCall(guarded(factorization.caught_, [&] {
    for (PetscInt j = 0; j < columns; ++j)
      if (factorization.holds_block_)
        std::fill_n(values + j * size, size, 0.0);
      else
        factorization.block_->solve(std::span(values + j * size, size));
  }));
  PetscCall(MatDenseRestoreArray(solution, &values));
  return 0;
}

} // namespace amontons
