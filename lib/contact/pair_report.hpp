// What books, reports and the certificate ask of a contact pair, whatever its formulation.
#pragma once

#include "contact/contact_history.hpp"
#include "contact/contact_pair.hpp"
#include "contact/contact_points.hpp"
#include "contact/contact_samples.hpp"
#include "form/form.hpp"

#include <array>
#include <vector>

namespace amontons {

/// What friction adds up to over the points of this rank.
struct TangentialSums {
  double stick_area = 0.0, slip_area = 0.0;
  double dissipation = 0.0; // ∫ σ_t · slip over the increment, >= 0
  double work = 0.0;        // ∫ σ_t · (u_slave − u_master), a rigid master's motion not included
  /// The trapezoidal work of the shear traction over the increment, less what the end of the increment says,
  /// dissipation and stored energy: what book-keeping by the ends of increments is off at the interface.
  double mismatch = 0.0;
  double change = 0.0; // Σ ½ |Δσ_t · Δg_t|
};

/// Totals of one pair over all ranks.
struct ContactTotals {
  std::array<double, 3> force{};    // on the slave
  std::array<double, 3> moment{};   // of that force about the origin (reference places)
  double area = 0.0;                // of slave points in contact, weighted
  double max_pressure = 0.0;        // nodal
  double largest_penetration = 0.0; // −g over the points in contact, relative to the facet size
  // Zero without friction:
  std::array<double, 3> tangential_force{}; // on the slave; part of `force`
  double stick_area = 0.0, slip_area = 0.0, open_area = 0.0;
  double dissipation = 0.0; // in the increment since the last accepted state
  double turning = 0.0;     // see ContactForm::turning_work
  double path_error = 0.0;  // of the shear's work in that increment: |mismatch| + change of TangentialSums
};

class PairReport {
 public:
  PairReport() = default;
  PairReport(const PairReport&) = delete;
  PairReport& operator=(const PairReport&) = delete;
  virtual ~PairReport() = default;

  virtual const ContactPair& pair() const = 0;
  /// See ContactPair::holds_floating_body, which is known when the places of all pairs are.
  virtual void hold_floating_body(bool holds) = 0;
  /// Where the multipliers live.
  virtual const NodeField& nodes() const = 0;
  /// Multipliers at nodes(), held or as of the last evaluation: traction, <= 0 in contact.
  virtual const std::vector<double>& multipliers() const = 0;
  virtual void hold_multipliers(std::vector<double> multipliers) = 0;
  /// Traction per unknown multiplier of the layout's extra field (`semismooth`).
  virtual double multiplier_scale() const { return 1.0; }
  virtual const ContactPoints& points() const = 0;
  /// What the pair remembers of the last accepted state, and taking that up again.
  virtual ContactHistory accepted() const = 0;
  virtual void restore(const ContactHistory& history) = 0;
  /// What of an accepted state follows from its unknowns and need not be in a checkpoint. Collective.
  virtual void remember(const State&) {}

  /// What the solver claims, point by point, with the nodal pressure summed over ranks. Collective.
  virtual ContactSamples samples(const State& state) = 0;
  /// Collective.
  virtual ContactTotals totals(const State& state) = 0;
  /// The contact tractions' virtual work on the displacement itself, ∫ σ n·(u_slave − u_master) + σ_t·(u_slave −
  /// u_master), over all ranks (a rigid master's motion not included). Collective.
  virtual double work_of_displacement(const State& state) = 0;
  /// The rigid master where it is now.
  virtual std::array<double, 3> rigid_shift() const = 0;
};

} // namespace amontons
