// A Form adds its part to the residual and the tangent and keeps its own history: bulk solid, loads, contact, later
// inertia, heat ... Forms do not know each other, the solver, or which unknowns are prescribed.
#pragma once

#include "fe/dof_layout.hpp"

#include <any>
#include <span>
#include <string>
#include <vector>

namespace amontons {

/// The iterate at which forms are evaluated.
struct State {
  double time = 0.0;
  Vec unknowns = nullptr;               // global vector of the layout
  std::span<const double> displacement; // local nodes x dim, ghosts and ties up to date
  /// True until the first tangent of an increment has been made: a contact form that has nothing in contact may then
  /// guess where contact will be, so that bodies held by contact alone are held from the first iteration on.
  bool first_guess = false;
};

/// Residual under assembly: out-of-balance force (internal minus external) for displacement equations.
class Residual {
 public:
  Residual(const DofLayout& layout, Vec global)
      : layout_(layout), global_(global), nodal_(std::size_t(layout.mesh().num_local()) * layout.dim()) {}
  /// Forces at this rank's nodes (num_local x dim), summed over ranks by finish().
  std::span<double> nodal() { return nodal_; }
  /// Adds to any equations, on this rank or not.
  void add(std::span<const PetscInt> equations, std::span<const double> values) {
    AMT_PETSC(
        VecSetValues(global_, static_cast<PetscInt>(equations.size()), equations.data(), values.data(), ADD_VALUES));
  }
  /// Says that there is no residual at this state and why, as the end of a sentence ("in body 'tube' det F is not
  /// positive"): a return value and never an exception, for the other ranks go on. The increment is then cut back.
  void fail(const std::string& reason) {
    if (failure_.empty()) failure_ = reason;
  }
  /// The first reason given on this rank; empty: none.
  const std::string& failure() const { return failure_; }
  /// Sums everything up in the global vector. Collective.
  void finish() {
    AMT_PETSC(VecAssemblyBegin(global_));
    AMT_PETSC(VecAssemblyEnd(global_));
    layout_.add_forces(nodal_, global_);
  }

 private:
  const DofLayout& layout_;
  Vec global_;
  std::vector<double> nodal_;
  std::string failure_;
};

/// Tangent under assembly. Rows and columns of prescribed equations are dropped by the Problem that owns the matrix.
class Tangent {
 public:
  virtual ~Tangent() = default;
  /// Adds a dense square block, row-major, to the given equations.
  virtual void add(std::span<const PetscInt> equations, std::span<const double> block) = 0;
};

/// Collects which equations couple, before a matrix exists.
class Coupling {
 public:
  virtual ~Coupling() = default;
  /// Each of these equations couples to each other one.
  virtual void add(std::span<const PetscInt> equations) = 0;
};

class Switching;

class Form {
 public:
  Form() = default;
  Form(const Form&) = delete;
  Form& operator=(const Form&) = delete;
  virtual ~Form() = default;

  /// Names the form's part in timings and messages.
  virtual const char* name() const = 0;

  virtual void couple(Coupling& coupling) const = 0;
  virtual void add_residual(const State& state, Residual& residual) = 0;
  /// The derivative of the residual: a part that never changes, which a Problem assembles once, and the rest. A form
  /// whose tangent is all of one kind leaves it at add_tangent and tangent_is_constant.
  virtual void add_tangent(const State& state, Tangent& tangent) = 0;
  virtual bool tangent_is_constant() const { return false; }
  virtual void add_constant_tangent(const State& state, Tangent& tangent) {
    if (tangent_is_constant()) add_tangent(state, tangent);
  }
  virtual void add_changing_tangent(const State& state, Tangent& tangent) {
    if (!tangent_is_constant()) add_tangent(state, tangent);
  }
  /// Does it harm when supports that have moved leave the body behind in the first guess of an increment, so that all
  /// of the motion is in the cells at the supports? Then the Problem's solver moves the body along.
  virtual bool wants_predictor() const { return false; }
  virtual bool tangent_is_symmetric() const { return true; }
  /// Would add_tangent add other numbers than at its last call? Asked on each rank for itself.
  virtual bool tangent_changed(const State&) { return !tangent_is_constant(); }
  /// Does the state need couplings that couple() did not name when last called? Asked on each rank for itself; a form
  /// that says yes names them from then on.
  virtual bool coupling_changed(const State&) { return false; }

  /// The form as one with branches; null for a form without any.
  virtual Switching* switching() { return nullptr; }

  /// Accepts the state as the start of the next increment, or goes back to the last accepted one.
  virtual void commit(const State&) {}
  virtual void roll_back() {}
  /// What comes goes another way than the last increment: nothing is to be guessed from that.
  virtual void forget_course() {}
  /// A copy of all that commit() changes, empty for a form without history; and the way back to it, from whatever has
  /// been tried or accepted since.
  virtual std::any history() const { return {}; }
  virtual void restore(const std::any&) {}

  /// Energy stored by this form on this rank.
  virtual double stored_energy(const State&) { return 0.0; }
};

} // namespace amontons
