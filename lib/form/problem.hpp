// A Problem is a sum of forms with some displacements prescribed: all that a solver sees. It assembles residual and
// tangent, keeps the matrix pattern, and remembers what need not be assembled again.
#pragma once

#include "base/expression.hpp"
#include "fe/shared_nodes.hpp"
#include "form/form.hpp"
#include "form/kept_rows.hpp"
#include "form/sparsity.hpp"
#include "form/switching.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace amontons {

/// A displacement component of all nodes of a group follows an expression of t, x, y, z (x, y, z: reference place).
struct PrescribedDisplacement {
  std::string group;
  int component;
  Expression value;
};

class Problem {
 public:
  /// Forms are added up in the order given. Collective.
  Problem(const DofLayout& layout, std::vector<std::unique_ptr<Form>> forms,
          std::vector<PrescribedDisplacement> prescribed);

  const DofLayout& layout() const { return layout_; }
  MPI_Comm comm() const { return layout_.mesh().comm; }
  bool tangent_is_symmetric() const;

  /// Starts an increment that ends at `time`: evaluates the prescribed displacements there and writes them into the
  /// unknowns. Collective.
  void begin_increment(double time, Vec unknowns);
  /// Makes the unknowns the start of the next increment, or returns forms and time to the last such start (the caller
  /// keeps the unknowns). Collective.
  void commit(Vec unknowns);
  void roll_back();
  /// The next increment begins another course of loading: Form::forget_course.
  void forget_course();

  /// What commit() changes: to go back over more than one accepted state.
  struct Snapshot {
    double time = 0.0, largest_force = 0.0;
    std::vector<std::any> histories; // one a form
  };
  Snapshot snapshot() const;
  /// Makes the snapshot the last accepted state (the caller keeps the unknowns).
  void restore(const Snapshot& snapshot);
  /// Goes on from a checkpoint: the accepted time, and largest_force() of the run that wrote it. The histories of the
  /// forms have been restored one by one.
  void resume(double time, double largest_force);
  double largest_force() const { return largest_accepted_force_; }
  /// Puts a state in place that was solved before as the end of an increment from the last accepted state, and
  /// evaluates its residual. Collective.
  void revisit(double time, Vec unknowns);

  double time() const { return time_; }
  /// Time of the last accepted state.
  double accepted_time() const { return accepted_time_; }

  /// The state at `unknowns` (valid until the next call of any member). Collective.
  State state_at(Vec unknowns);
  /// Is the next tangent the first of its increment? Forms then guess, and it need not be the residual's derivative.
  bool is_first_guess() const { return first_guess_; }

  /// Out-of-balance forces; zero in the equations of prescribed displacements. False, the same on every rank, where a
  /// form has no residual: `result` is then of no use, and failure() says why. Collective.
  bool residual(Vec unknowns, Vec result);
  /// Why the last residual could not be evaluated, as the end of a sentence; empty when it could. Same on every rank.
  const std::string& failure() const { return failure_; }
  /// The last residual with the reactions of the supports, in the equations of prescribed displacements.
  Vec raw_residual() const { return raw_; }
  /// Norm of the forces that met in the last residual (internal, contact, loads, reactions): what an out-of-balance
  /// force is small against. Not below a thousandth of what it was in any accepted state. Same on every rank.
  double force_scale() const { return force_scale_; }

  /// What of the last residual may be rounding: some machine epsilons times the norm of (diagonal of the constant
  /// tangent x unknowns), or of the first tangent where the solid is not linear. A stiff body moved by a soft one has
  /// internal forces that cancel far more than the load. Zero before the first tangent. Same on every rank.
  double rounding() const { return rounding_; }

  /// Do supports move in the increment begun, so that a form wants the body moved along first
  /// (Form::wants_predictor)? No longer once that has been done. Same on every rank.
  bool wants_prediction() const { return wants_prediction_; }
  /// One Newton step from the last accepted state that knows where the supports go: takes their motion Δ back out of
  /// `unknowns`, assembles tangent K and residual r there, and gives `load` = r + K Δ in the free equations; then
  /// `unknowns` + Δ − K^-1 load is the prediction. False where there is no residual. Collective.
  bool begin_prediction(Vec unknowns, Mat matrix, Vec load);
  /// `unknowns` += Δ − step.
  void end_prediction(Vec unknowns, Vec step);

  /// A matrix for the tangent. Collective.
  MatHandle new_matrix();
  /// Assembles the tangent at `unknowns`, only if it would differ from the last one; returns whether it did. The
  /// pattern grows when a form asks for it. Collective.
  bool tangent(Vec unknowns, Mat matrix);

  /// Owned equations, ascending, that forms without a constant tangent add to, on whichever rank: tangents of the same
  /// pattern_number() differ in the rows and columns of these only. Collective.
  std::vector<PetscInt> changing_equations() const;
  /// Counts the patterns that tangents have had; 0 before the first tangent. Same on every rank.
  int pattern_number() const { return pattern_number_; }

  /// Is this equation (owned by this rank) prescribed?
  bool is_prescribed(PetscInt equation) const { return prescribed_flags_[equation - layout_.first_equation()] != 0; }
  const std::vector<PrescribedDisplacement>& prescribed() const { return prescribed_; }
  double stored_energy(Vec unknowns);

  /// The forms that have branches, in the order of the forms.
  std::vector<Switching*> switching() const;
  /// Adds the form to residual and tangent until it is taken out again: a support on the way to a solution. It must not
  /// couple equations that the others do not, has no history here, and is not owned.
  void lean_on(Form& support);
  void stand_alone();

 private:
  class MatrixTangent;
  class DiagonalTangent;
  class SupportLoad;
  void find_prescribed();
  void estimate_rounding(Vec unknowns);
  void build_pattern(Mat matrix);
  double probe_diagonal(const State& state);
  void assemble_constant(const State& state, Mat matrix);
  bool any_rank(bool mine) const;
  bool is_linear() const;
  bool is_dropped(PetscInt equation) const;
  std::vector<double> at_equations(Vec vector, const std::vector<PetscInt>& equations) const;
  void share_failure(const std::string& mine);
  void add_changing(const State& state, Mat matrix);

  const DofLayout& layout_;
  std::vector<std::unique_ptr<Form>> forms_;
  Form* support_ = nullptr; // see lean_on
  std::vector<PrescribedDisplacement> prescribed_;
  std::vector<std::uint8_t> prescribed_flags_; // per owned equation
  std::vector<PetscInt> prescribed_equations_; // owned, ascending
  std::vector<PetscInt> foreign_prescribed_;   // other ranks' prescribed equations that local forms touch, ascending
  VecHandle raw_;
  SharedNodes shared_nodes_;
  VecHandle support_motion_;
  std::vector<double> displacement_;
  double time_ = 0.0, accepted_time_ = 0.0;
  KeptRows constant_rows_;       // of the constant tangent
  VecHandle diagonal_, scratch_; // of the constant tangent, or of the first one where the solid is not linear
  VecHandle cell_sizes_;         // around each equation's nodes, where the solid is not linear
  double rounding_ = 0.0;
  double force_scale_ = 0.0, largest_accepted_force_ = 0.0;
  std::string failure_;
  bool first_guess_ = false, wants_prediction_ = false;
  bool constant_ready_ = false, tangent_ready_ = false;
  int pattern_number_ = 0; // of the constant tangent in use
};

} // namespace amontons
