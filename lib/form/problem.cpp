#include "form/problem.hpp"

#include "base/error.hpp"
#include "base/timer.hpp"
#include "form/block_adder.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace amontons {

namespace {

/// A scene that has been unloaded completely has no forces left but those that are small against earlier ones.
constexpr double unloaded_ratio = 1e-3;
/// Machine epsilons of rounding in a sum over the neighbours of a node.
constexpr double rounding_factor = 8.0;

/// Size of the cells around each equation's nodes, on whichever rank: side of their box over their order; zero for
/// multipliers. Collective.
VecHandle cell_sizes(const DofLayout& layout) {
  const auto& mesh = layout.mesh();
  std::vector<double> sizes(std::size_t(mesh.num_local()) * mesh.dim, 0.0);
  for (const auto& block : mesh.blocks)
    for (std::int32_t c = 0; c < block.size(); ++c) {
      double side = 0.0;
      for (int i = 0; i < mesh.dim; ++i) {
        double low = 1e300, high = -1e300;
        for (const auto node : block.cell(c)) {
          low = std::min(low, mesh.position(node)[i]);
          high = std::max(high, mesh.position(node)[i]);
        }
        side = std::max(side, high - low);
      }
      for (const auto node : block.cell(c))
        for (int i = 0; i < mesh.dim; ++i) {
          double& size = sizes[std::size_t(node) * mesh.dim + i];
          size = std::max(size, side / mesh.order);
        }
    }
  auto at_equations = layout.new_vector();
  AMT_PETSC(VecSet(at_equations, 0.0));
  layout.take_largest(sizes, at_equations);
  return at_equations;
}

} // namespace

/// Puts blocks into a PETSc matrix, leaving out rows and columns of prescribed equations.
class Problem::MatrixTangent : public Tangent {
 public:
  MatrixTangent(const Problem& problem, Mat matrix) : problem_(problem), blocks_(matrix) {}
  void add(std::span<const PetscInt> equations, std::span<const double> block) override {
    rows_.resize(equations.size());
    for (std::size_t i = 0; i < equations.size(); ++i)
      rows_[i] = problem_.is_dropped(equations[i]) ? -1 : equations[i];
    for (std::size_t i = 0; i < equations.size(); ++i)
      diagonal_sum_ += std::abs(block[i * (equations.size() + 1)]);
    blocks_.add(rows_, block);
  }
  /// Σ |diagonal| of all that was added on this rank.
  double diagonal_sum() const { return diagonal_sum_; }

 private:
  const Problem& problem_;
  BlockAdder blocks_;
  std::vector<PetscInt> rows_;
  double diagonal_sum_ = 0.0;
};

/// Adds up the diagonal only.
class Problem::DiagonalTangent : public Tangent {
 public:
  explicit DiagonalTangent(Vec diagonal) : diagonal_(diagonal) {}
  void add(std::span<const PetscInt> equations, std::span<const double> block) override {
    for (std::size_t i = 0; i < equations.size(); ++i)
      AMT_PETSC(VecSetValue(diagonal_, equations[i], block[i * (equations.size() + 1)], ADD_VALUES));
  }

 private:
  Vec diagonal_;
};

/// Adds the forces on the free equations that the motion of the supports brings about, to first order.
class Problem::SupportLoad : public Tangent {
 public:
  SupportLoad(const Problem& problem, Vec load)
      : problem_(problem), load_(load), motion_(problem.support_motion_),
        foreign_(problem.at_equations(problem.support_motion_, problem.foreign_prescribed_)) {}
  void add(std::span<const PetscInt> equations, std::span<const double> block) override {
    const std::size_t size = equations.size();
    rows_.clear();
    forces_.clear();
    motions_.clear();
    for (const PetscInt equation : equations)
      motions_.push_back(problem_.is_dropped(equation) ? motion_of(equation) : 0.0);
    if (std::all_of(motions_.begin(), motions_.end(), [](double motion) { return motion == 0.0; })) return;
    for (std::size_t i = 0; i < size; ++i) {
      if (problem_.is_dropped(equations[i])) continue;
      rows_.push_back(equations[i]);
      forces_.push_back(std::inner_product(motions_.begin(), motions_.end(), block.begin() + i * size, 0.0));
    }
    AMT_PETSC(VecSetValues(load_, static_cast<PetscInt>(rows_.size()), rows_.data(), forces_.data(), ADD_VALUES));
  }

 private:
  double motion_of(PetscInt equation) const {
    const PetscInt local = equation - problem_.layout_.first_equation();
    if (local >= 0 && local < problem_.layout_.num_owned()) return motion_[local];
    const auto& known = problem_.foreign_prescribed_;
    return foreign_[std::lower_bound(known.begin(), known.end(), equation) - known.begin()];
  }
  const Problem& problem_;
  Vec load_;
  VecReader motion_;
  std::vector<double> foreign_; // as foreign_prescribed_
  std::vector<PetscInt> rows_;
  std::vector<double> forces_, motions_;
};

Problem::Problem(const DofLayout& layout, std::vector<std::unique_ptr<Form>> forms,
                 std::vector<PrescribedDisplacement> prescribed)
    : layout_(layout), forms_(std::move(forms)), prescribed_(std::move(prescribed)), raw_(layout.new_vector()),
      shared_nodes_(layout.mesh(), layout.dim()), support_motion_(layout.new_vector()),
      displacement_(std::size_t(layout.mesh().num_local()) * layout.dim()) {
  find_prescribed();
}

void Problem::find_prescribed() {
  const auto& mesh = layout_.mesh();
  prescribed_flags_.assign(layout_.num_owned(), 0);
  const auto& tied = layout_.tied();
  std::vector<PetscInt> tied_equations;
  for (std::size_t i = 0; i < tied.size(); ++i)
    tied_equations.push_back(layout_.tied_equation(i));
  together(comm(), [&] {
    for (const auto& condition : prescribed_)
      for (const auto node : mesh.node_groups.at(condition.group)) {
        const PetscInt equation = layout_.equation(node, condition.component);
        const auto clash = std::find(tied_equations.begin(), tied_equations.end(), equation);
        if (clash != tied_equations.end())
          throw UserError(
              "boundary: the groups '" + condition.group + "' (displacement " + "xyz"[condition.component] + ") and '" +
              tied[clash - tied_equations.begin()].group +
              "' (resultant in the same direction) share a node; a node cannot be prescribed and moved by a "
              "force at once. Take the shared nodes out of one of the groups.");
        if (node < mesh.num_owned) prescribed_flags_[equation - layout_.first_equation()] = 1;
      }
  });
  for (PetscInt i = 0; i < layout_.num_owned(); ++i)
    if (prescribed_flags_[i]) prescribed_equations_.push_back(layout_.first_equation() + i);
}

/// Is the solid linear?
bool Problem::is_linear() const {
  return std::none_of(forms_.begin(), forms_.end(), [](const auto& form) { return form->wants_predictor(); });
}

bool Problem::tangent_is_symmetric() const {
  return std::all_of(forms_.begin(), forms_.end(), [](const auto& form) { return form->tangent_is_symmetric(); });
}

/// Is this equation prescribed, on whatever rank? For those that local forms touch.
bool Problem::is_dropped(PetscInt equation) const {
  const PetscInt local = equation - layout_.first_equation();
  if (local >= 0 && local < layout_.num_owned()) return prescribed_flags_[local] != 0;
  return std::binary_search(foreign_prescribed_.begin(), foreign_prescribed_.end(), equation);
}

/// Entries of a global vector, whoever owns them. Collective.
std::vector<double> Problem::at_equations(Vec vector, const std::vector<PetscInt>& equations) const {
  const auto size = static_cast<PetscInt>(equations.size());
  VecHandle ours;
  AMT_PETSC(VecCreateSeq(PETSC_COMM_SELF, size, ours.put()));
  IsHandle from;
  AMT_PETSC(ISCreateGeneral(comm(), size, equations.data(), PETSC_COPY_VALUES, from.put()));
  ScatterHandle scatter;
  AMT_PETSC(VecScatterCreate(vector, from, ours, nullptr, scatter.put()));
  AMT_PETSC(VecScatterBegin(scatter, vector, ours, INSERT_VALUES, SCATTER_FORWARD));
  AMT_PETSC(VecScatterEnd(scatter, vector, ours, INSERT_VALUES, SCATTER_FORWARD));
  const VecReader values(ours);
  return {values.data(), values.data() + size};
}

bool Problem::any_rank(bool mine) const {
  int any = mine ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, comm());
  return any != 0;
}

void Problem::begin_increment(double time, Vec unknowns) {
  time_ = time;
  first_guess_ = true;
  const auto& mesh = layout_.mesh();
  AMT_PETSC(VecSet(support_motion_, 0.0));
  {
    VecArray values(unknowns), motion(support_motion_);
    for (const auto& condition : prescribed_)
      for (const auto node : mesh.node_groups.at(condition.group)) {
        if (node >= mesh.num_owned) continue;
        const PetscInt at = layout_.equation(node, condition.component) - layout_.first_equation();
        const double value = condition.value(time, mesh.position(node));
        motion[at] += value - values[at];
        values[at] = value;
      }
  }
  wants_prediction_ = !is_linear();
  if (!wants_prediction_) return;
  double largest = 0.0;
  AMT_PETSC(VecNorm(support_motion_, NORM_INFINITY, &largest));
  wants_prediction_ = largest > 0.0;
}

bool Problem::begin_prediction(Vec unknowns, Mat matrix, Vec load) {
  wants_prediction_ = false;
  AMT_PETSC(VecAXPY(unknowns, -1.0, support_motion_));
  if (!residual(unknowns, load)) return false;
  tangent(unknowns, matrix);
  const auto state = state_at(unknowns);
  SupportLoad supports(*this, load);
  for (const auto& form : forms_)
    form->add_tangent(state, supports);
  AMT_PETSC(VecAssemblyBegin(load));
  AMT_PETSC(VecAssemblyEnd(load));
  return true;
}

void Problem::end_prediction(Vec unknowns, Vec step) {
  AMT_PETSC(VecAXPY(unknowns, 1.0, support_motion_));
  AMT_PETSC(VecAXPY(unknowns, -1.0, step));
}

void Problem::commit(Vec unknowns) {
  largest_accepted_force_ = std::max(largest_accepted_force_, force_scale_);
  accepted_time_ = time_;
  const auto state = state_at(unknowns);
  for (const auto& form : forms_)
    form->commit(state);
}

void Problem::roll_back() {
  time_ = accepted_time_;
  for (const auto& form : forms_)
    form->roll_back();
}

void Problem::forget_course() {
  for (const auto& form : forms_)
    form->forget_course();
}

Problem::Snapshot Problem::snapshot() const {
  Snapshot snapshot{.time = accepted_time_, .largest_force = largest_accepted_force_, .histories = {}};
  for (const auto& form : forms_)
    snapshot.histories.push_back(form->history());
  return snapshot;
}

void Problem::restore(const Snapshot& snapshot) {
  resume(snapshot.time, snapshot.largest_force);
  for (std::size_t i = 0; i < forms_.size(); ++i)
    if (snapshot.histories[i].has_value()) forms_[i]->restore(snapshot.histories[i]);
}

void Problem::resume(double time, double largest_force) {
  time_ = accepted_time_ = time;
  largest_accepted_force_ = largest_force;
}

void Problem::revisit(double time, Vec unknowns) {
  time_ = time;
  first_guess_ = false;
  const auto result = layout_.new_vector();
  residual(unknowns, result);
}

State Problem::state_at(Vec unknowns) {
  layout_.gather_displacement(unknowns, displacement_);
  return {.time = time_, .unknowns = unknowns, .displacement = displacement_, .first_guess = first_guess_};
}

void Problem::estimate_rounding(Vec unknowns) {
  if (!diagonal_) return;
  AMT_PETSC(VecPointwiseMult(scratch_, diagonal_, unknowns));
  if (!is_linear()) {
    // F = 1 + ∂u/∂X is rounded like 1 however small u is: as if u were off by that part of the cells' size.
    VecArray forces(scratch_);
    VecReader stiffness(diagonal_);
    const VecReader sizes(cell_sizes_);
    for (PetscInt i = 0; i < layout_.mesh().num_owned * layout_.dim(); ++i)
      forces[i] = std::abs(forces[i]) + std::abs(stiffness[i]) * sizes[i];
  }
  AMT_PETSC(VecNorm(scratch_, NORM_2, &rounding_));
  rounding_ *= rounding_factor * PETSC_MACHINE_EPSILON;
}

/// The reason of the first rank that has one, told to all.
void Problem::share_failure(const std::string& mine) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm(), &rank);
  MPI_Comm_size(comm(), &ranks);
  int first = mine.empty() ? ranks : rank;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm());
  failure_ = mine;
  if (first == ranks) return;
  auto size = static_cast<int>(mine.size());
  MPI_Bcast(&size, 1, MPI_INT, first, comm());
  failure_.resize(static_cast<std::size_t>(size));
  MPI_Bcast(failure_.data(), size, MPI_CHAR, first, comm());
}

bool Problem::residual(Vec unknowns, Vec result) {
  estimate_rounding(unknowns);
  const auto state = state_at(unknowns);
  AMT_PETSC(VecSet(raw_, 0.0));
  Residual residual(layout_, raw_);
  double largest = 0.0; // of the squared norms of the forces of the first form, the first two, the first three ...
  std::vector<double> squares(forms_.size(), 0.0);
  for (std::size_t i = 0; i < forms_.size(); ++i) {
    const Phase phase(forms_[i]->name());
    forms_[i]->add_residual(state, residual);
    squares[i] = shared_nodes_.square_of_sum(residual.nodal());
  }
  if (support_) support_->add_residual(state, residual);
  MPI_Allreduce(MPI_IN_PLACE, squares.data(), static_cast<int>(squares.size()), MPI_DOUBLE, MPI_SUM, comm());
  for (const double square : squares)
    largest = std::max(largest, square);
  residual.finish();
  share_failure(residual.failure());
  AMT_PETSC(VecCopy(raw_, result));
  if (!failure_.empty()) return false;
  {
    VecArray values(result);
    for (const PetscInt equation : prescribed_equations_)
      values[equation - layout_.first_equation()] = 0.0;
  }
  double norm = 0.0;
  AMT_PETSC(VecNorm(raw_, NORM_2, &norm));
  force_scale_ = std::max({std::sqrt(largest), norm, unloaded_ratio * largest_accepted_force_});
  return true;
}

MatHandle Problem::new_matrix() {
  MatHandle matrix;
  AMT_PETSC(MatCreate(comm(), matrix.put()));
  AMT_PETSC(MatSetSizes(matrix, layout_.num_owned(), layout_.num_owned(), PETSC_DETERMINE, PETSC_DETERMINE));
  AMT_PETSC(MatSetType(matrix, MATAIJ));
  if (layout_.num_extra() == 0) AMT_PETSC(MatSetBlockSize(matrix, layout_.dim()));
  build_pattern(matrix);
  return matrix;
}

void Problem::build_pattern(Mat matrix) {
  const Phase phase("pattern");
  Sparsity sparsity(layout_);
  for (const auto& form : forms_)
    form->couple(sparsity);

  // Which of the other ranks' equations that our forms touch are prescribed there?
  const auto foreign = sparsity.foreign_equations();
  VecHandle flags = layout_.new_vector();
  {
    VecArray values(flags);
    for (PetscInt i = 0; i < values.size(); ++i)
      values[i] = prescribed_flags_[i];
  }
  const auto values = at_equations(flags, foreign);
  foreign_prescribed_.clear();
  for (std::size_t i = 0; i < foreign.size(); ++i)
    if (values[i] != 0.0) foreign_prescribed_.push_back(foreign[i]);

  sparsity.preallocate(matrix);
  constant_ready_ = tangent_ready_ = false;
}

void Problem::add_changing(const State& state, Mat matrix) {
  MatrixTangent tangent(*this, matrix);
  for (const auto& form : forms_) {
    const Phase phase(form->name());
    form->add_changing_tangent(state, tangent);
  }
  if (support_) support_->add_tangent(state, tangent);
  const Phase phase("matrix");
  AMT_PETSC(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  AMT_PETSC(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

/// Takes the diagonal of the whole tangent, in problems where the constant part is not the solid; returns the sum of
/// absolute values.
double Problem::probe_diagonal(const State& state) {
  DiagonalTangent tangent(diagonal_);
  for (const auto& form : forms_)
    form->add_tangent(state, tangent);
  AMT_PETSC(VecAssemblyBegin(diagonal_));
  AMT_PETSC(VecAssemblyEnd(diagonal_));
  double sum = 0.0;
  AMT_PETSC(VecNorm(diagonal_, NORM_1, &sum));
  return sum;
}

std::vector<PetscInt> Problem::changing_equations() const {
  class Marker : public Coupling {
   public:
    explicit Marker(Vec flags) : flags_(flags) {}
    void add(std::span<const PetscInt> equations) override {
      ones_.assign(equations.size(), 1.0);
      AMT_PETSC(
          VecSetValues(flags_, static_cast<PetscInt>(equations.size()), equations.data(), ones_.data(), INSERT_VALUES));
    }

   private:
    Vec flags_;
    std::vector<double> ones_;
  };
  const auto flags = layout_.new_vector();
  Marker marker(flags);
  for (const auto& form : forms_)
    if (!form->tangent_is_constant()) form->couple(marker);
  if (support_) support_->couple(marker);
  AMT_PETSC(VecAssemblyBegin(flags));
  AMT_PETSC(VecAssemblyEnd(flags));
  std::vector<PetscInt> rows;
  const VecReader values(flags);
  for (PetscInt i = 0; i < values.size(); ++i)
    if (values[i] != 0.0) rows.push_back(layout_.first_equation() + i);
  return rows;
}

/// The constant part with the whole pattern in place; rows that others add to are kept for later tangents. One
/// assembly for all: PETSc gives preallocated places away that an assembly finds unused.
void Problem::assemble_constant(const State& state, Mat matrix) {
  PetscBool is_assembled = PETSC_FALSE;
  AMT_PETSC(MatAssembled(matrix, &is_assembled));
  if (is_assembled) AMT_PETSC(MatZeroEntries(matrix));
  AMT_PETSC(MatSetOption(matrix, MAT_NEW_NONZERO_LOCATIONS, PETSC_TRUE));
  AMT_PETSC(MatSetOption(matrix, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_TRUE));
  MatrixTangent tangent(*this, matrix);
  for (const auto& form : forms_) {
    const Phase phase(form->name());
    form->add_constant_tangent(state, tangent);
  }
  // Prescribed and idle equations get the mean diagonal, so that they spoil neither conditioning nor scaling.
  double mean = tangent.diagonal_sum();
  MPI_Allreduce(MPI_IN_PLACE, &mean, 1, MPI_DOUBLE, MPI_SUM, comm());
  diagonal_ = layout_.new_vector();
  scratch_ = layout_.new_vector();
  if (!is_linear()) {
    mean = probe_diagonal(state);
    cell_sizes_ = cell_sizes(layout_);
  }
  mean = mean > 0.0 ? mean / static_cast<double>(layout_.num_global()) : 1.0;
  for (const auto& equations : {std::span<const PetscInt>(prescribed_equations_), std::span(layout_.idle_equations())})
    for (const PetscInt equation : equations)
      AMT_PETSC(MatSetValue(matrix, equation, equation, mean, ADD_VALUES));
  class Zeros : public Coupling {
   public:
    explicit Zeros(MatrixTangent& tangent) : tangent_(tangent) {}
    void add(std::span<const PetscInt> equations) override {
      zeros_.assign(equations.size() * equations.size(), 0.0);
      tangent_.add(equations, zeros_);
    }

   private:
    MatrixTangent& tangent_;
    std::vector<double> zeros_;
  };
  Zeros zeros(tangent);
  for (const auto& form : forms_)
    if (!form->tangent_is_constant()) form->couple(zeros);
  const Phase phase("matrix");
  AMT_PETSC(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  AMT_PETSC(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  AMT_PETSC(MatSetOption(matrix, MAT_NEW_NONZERO_LOCATIONS, PETSC_FALSE));
  constant_rows_.store(matrix, changing_equations());
  if (is_linear()) AMT_PETSC(MatGetDiagonal(matrix, diagonal_));
  constant_ready_ = true;
  ++pattern_number_;
}

bool Problem::tangent(Vec unknowns, Mat matrix) {
  const auto state = state_at(unknowns);
  bool coupling_changed = false, tangent_changed = false;
  for (const auto& form : forms_) {
    coupling_changed = form->coupling_changed(state) || coupling_changed;
    tangent_changed = form->tangent_changed(state) || tangent_changed;
  }
  if (support_) tangent_changed = support_->tangent_changed(state) || tangent_changed;
  first_guess_ = false;
  if (any_rank(coupling_changed)) build_pattern(matrix);
  if (!any_rank(tangent_changed || !tangent_ready_)) return false;
  if (constant_ready_)
    constant_rows_.restore(matrix);
  else
    assemble_constant(state, matrix);
  add_changing(state, matrix);
  if (tangent_is_symmetric()) AMT_PETSC(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  tangent_ready_ = true;
  return true;
}

std::vector<Switching*> Problem::switching() const {
  std::vector<Switching*> found;
  for (const auto& form : forms_)
    if (auto* switching = form->switching()) found.push_back(switching);
  return found;
}

void Problem::lean_on(Form& support) {
  support_ = &support;
  constant_ready_ = tangent_ready_ = false; // it adds to rows that are not kept
}

void Problem::stand_alone() {
  support_ = nullptr;
  tangent_ready_ = false;
}

double Problem::stored_energy(Vec unknowns) {
  const auto state = state_at(unknowns);
  double energy = 0.0;
  for (const auto& form : forms_)
    energy += form->stored_energy(state);
  MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPI_DOUBLE, MPI_SUM, comm());
  return energy;
}

} // namespace amontons
