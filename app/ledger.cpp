// External forces e are what balances the bulk and the contact forms: e = bulk + contact = residual without the loads'
// part; without that of artificial viscosity, too, which acts on the bodies like a load. At supports they are the
// reactions, elsewhere the applied loads.
#include "ledger.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace amontons {

namespace {

/// Penetration at the start, relative to the facet size, that is more than rounding of the mesh's coordinates.
constexpr double overlap_tolerance = 1e-9;

} // namespace

Ledger::Ledger(Scene& scene)
    : scene_(scene), external_(scene.layout->new_vector()), external_old_(scene.layout->new_vector()),
      unknowns_old_(scene.layout->new_vector()), work_(scene.layout->new_vector()),
      rigid_force_old_(scene.contacts.size()), rigid_shift_old_(scene.contacts.size()),
      dissipated_(scene.contacts.size()) {
  for (const auto& condition : scene.problem->prescribed())
    if (std::none_of(reactions_.begin(), reactions_.end(),
                     [&](const auto& known) { return known.group == condition.group; }))
      reactions_.push_back({.group = condition.group});
  if (scene.stabilization) {
    viscous_ = scene.layout->new_vector();
    viscous_old_ = scene.layout->new_vector();
  }
  const auto state = scene.problem->state_at(unknowns_old_);
  for (auto* contact : scene.contacts)
    if (contact->totals(state).largest_penetration > overlap_tolerance) initial_overlap_ = true;
}

void Ledger::find_external_forces(Vec unknowns) {
  AMT_PETSC(VecCopy(scene_.problem->raw_residual(), external_));
  if (scene_.stabilization) {
    AMT_PETSC(VecSet(viscous_, 0.0));
    Residual viscous(*scene_.layout, viscous_);
    scene_.stabilization->add_residual(scene_.problem->state_at(unknowns), viscous);
    viscous.finish();
    AMT_PETSC(VecAXPY(external_, -1.0, viscous_));
  }
  if (!scene_.loads && !scene_.follower) return;
  AMT_PETSC(VecSet(work_, 0.0));
  Residual loads(*scene_.layout, work_);
  const auto state = scene_.problem->state_at(unknowns);
  if (scene_.loads) scene_.loads->add_residual(state, loads);
  if (scene_.follower) scene_.follower->add_residual(state, loads);
  loads.finish();
  AMT_PETSC(VecAXPY(external_, -1.0, work_));
}

/// This rank's parts of loads and reactions by node. The equation of a tied group holds its total force; what its nodes
/// get from the grip one by one is what the bulk takes up there.
std::vector<double> Ledger::nodal_external_forces(Vec unknowns) {
  const auto& layout = *scene_.layout;
  const auto& mesh = scene_.mesh;
  const int d = mesh.dim;
  const auto state = scene_.problem->state_at(unknowns);
  std::vector<double> forces(state.displacement.size(), 0.0);
  if (scene_.loads) forces = scene_.loads->nodal_forces(state.time);
  if (scene_.stabilization) {
    const auto viscous = scene_.stabilization->nodal_forces(state);
    for (std::size_t i = 0; i < forces.size(); ++i)
      forces[i] += viscous[i];
  }
  if (scene_.follower) {
    const auto pressure = scene_.follower->nodal_forces(state);
    std::transform(forces.begin(), forces.end(), pressure.begin(), forces.begin(), std::plus<>());
  }
  {
    VecReader raw(scene_.problem->raw_residual());
    for (PetscInt local = 0; local < mesh.num_owned * d; ++local)
      if (scene_.problem->is_prescribed(layout.first_equation() + local)) forces[local] += raw[local];
  }
  if (layout.tied().empty()) return forces;
  AMT_PETSC(VecSet(work_, 0.0));
  Residual internal(layout, work_);
  scene_.bulk->add_residual(state, internal);
  for (const auto& [group, component] : layout.tied())
    for (const auto node : mesh.node_groups.at(group)) {
      const std::size_t at = std::size_t(node) * d + component;
      forces[at] = internal.nodal()[at];
    }
  return forces;
}

void Ledger::collect_reactions() {
  const auto& mesh = scene_.mesh;
  VecReader raw(scene_.problem->raw_residual());
  for (auto& reaction : reactions_) {
    reaction.force = {};
    for (const auto node : mesh.node_groups.at(reaction.group))
      if (node < mesh.num_owned)
        for (int c = 0; c < mesh.dim; ++c) {
          const PetscInt equation = scene_.layout->equation(node, c);
          const PetscInt local = equation - scene_.layout->first_equation();
          if (local == node * mesh.dim + c && scene_.problem->is_prescribed(equation)) reaction.force[c] += raw[local];
        }
    MPI_Allreduce(MPI_IN_PLACE, reaction.force.data(), 3, MPI_DOUBLE, MPI_SUM, mesh.comm);
  }
}

void Ledger::collect_tied_displacements(Vec unknowns) {
  const auto& layout = *scene_.layout;
  tied_displacements_.assign(layout.tied().size(), 0.0);
  {
    VecReader u(unknowns);
    for (std::size_t i = 0; i < tied_displacements_.size(); ++i) {
      const PetscInt local = layout.tied_equation(i) - layout.first_equation();
      if (local >= 0 && local < layout.num_owned()) tied_displacements_[i] = u[local];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, tied_displacements_.data(), static_cast<int>(tied_displacements_.size()), MPI_DOUBLE,
                MPI_SUM, scene_.mesh.comm);
}

/// The work of body forces on the cell bubbles, which the nodes' forces leave out; to the sums of accept().
void Ledger::add_bubble_work(Vec unknowns, std::span<double> sums) {
  auto bubbles = scene_.bulk->loaded_bubbles(scene_.problem->state_at(unknowns));
  const auto& f = bubbles.forces;
  const auto& u = bubbles.displacements;
  bubbles_old_.forces.resize(f.size());
  bubbles_old_.displacements.resize(u.size());
  for (std::size_t i = 0; i < f.size(); ++i) {
    const double step = u[i] - bubbles_old_.displacements[i];
    sums[0] += 0.5 * (f[i] + bubbles_old_.forces[i]) * step;
    sums[1] += 0.5 * (f[i] - bubbles_old_.forces[i]) * step;
    sums[2] += 0.5 * std::abs((f[i] - bubbles_old_.forces[i]) * step);
    sums[3] += f[i] * u[i];
    sums[4] += std::abs(f[i] * u[i]);
  }
  bubbles_old_ = std::move(bubbles);
}

/// Σ ½ (f_old + f) · Δu of the forces that the stabilization resists with: by the trapezoidal rule as the external work
/// that it is a part of.
void Ledger::take_artificial_work(Vec unknowns) {
  if (!scene_.stabilization) return;
  AMT_PETSC(VecWAXPY(work_, -1.0, unknowns_old_, unknowns));
  PetscScalar now = 0.0, before = 0.0;
  AMT_PETSC(VecDot(viscous_, work_, &now));
  AMT_PETSC(VecDot(viscous_old_, work_, &before));
  artificial_work_ += 0.5 * (now + before);
  AMT_PETSC(VecCopy(viscous_, viscous_old_));
}

/// What the trapezoidal work of an increment may be off, sliding apart: ½ Δe·Δu, less what of it is elastic energy of
/// linear bodies, for which the rule is exact (accuracy/certificate.hpp). Where a body is not linear, Σ ½ |Δe·Δu|.
double Ledger::trapezoid_error(Vec unknowns, double change, double absolute_change) {
  if (!scene_.bulk->tangent_is_constant()) return absolute_change;
  AMT_PETSC(VecWAXPY(work_, -1.0, unknowns_old_, unknowns));
  return std::max(0.0, change - scene_.bulk_energy(work_));
}

void Ledger::accept(Vec unknowns) {
  const auto& problem = *scene_.problem;
  find_external_forces(unknowns);
  collect_reactions();
  collect_tied_displacements(unknowns);
  stored_energy_ = scene_.problem->stored_energy(unknowns);
  bulk_dissipation_ = scene_.bulk_dissipation(unknowns);

  double here[5] = {}; // work, ½ Δe·Δu, Σ ½ |Δe·Δu|, e·u, Σ|e·u|
  {
    VecReader e(external_), e_old(external_old_), u(unknowns), u_old(unknowns_old_);
    const PetscInt displacements = scene_.mesh.num_owned * scene_.mesh.dim; // multipliers do no work of their own
    for (PetscInt i = 0; i < displacements; ++i) {
      const double step = u[i] - u_old[i];
      here[0] += 0.5 * (e[i] + e_old[i]) * step;
      here[1] += 0.5 * (e[i] - e_old[i]) * step;
      here[2] += 0.5 * std::abs((e[i] - e_old[i]) * step);
      here[3] += e[i] * u[i];
      here[4] += std::abs(e[i] * u[i]);
    }
  }
  add_bubble_work(unknowns, here);
  MPI_Allreduce(MPI_IN_PLACE, here, 5, MPI_DOUBLE, MPI_SUM, problem.comm());
  double contact_work = 0.0; // ∫ σ (g − g0)
  double contact_error = 0.0;
  const auto state = scene_.problem->state_at(unknowns);
  for (std::size_t i = 0; i < scene_.contacts.size(); ++i) {
    auto& contact = *scene_.contacts[i];
    contact_work += contact.work_of_displacement(state);
    const bool is_rigid = std::holds_alternative<RigidMaster>(contact.pair().master);
    if (!is_rigid && !contact.pair().friction) continue;
    const auto totals = contact.totals(state);
    dissipated_[i] += totals.dissipation;
    contact_error += totals.path_error + std::abs(totals.turning);
    if (!is_rigid) continue;
    const auto& force = totals.force;
    const auto shift = contact.rigid_shift();
    for (int c = 0; c < 3; ++c) {
      const double step = shift[c] - rigid_shift_old_[i][c];
      here[0] += 0.5 * (force[c] + rigid_force_old_[i][c]) * step;
      here[1] += 0.5 * (force[c] - rigid_force_old_[i][c]) * step;
      here[2] += 0.5 * std::abs((force[c] - rigid_force_old_[i][c]) * step);
    }
    rigid_force_old_[i] = force;
    rigid_shift_old_[i] = shift;
  }
  if (initial_overlap_ && !opened_)
    external_work_ = stored_energy_ + dissipated_energy();
  else {
    external_work_ += here[0];
    work_uncertainty_ += contact_error + trapezoid_error(unknowns, here[1], here[2]);
  }
  opened_ = true;
  take_artificial_work(unknowns);
  const double internal_work = scene_.internal_work(unknowns);
  virtual_work_defect_ = here[3] - contact_work - internal_work;
  // A plastic body that is back in its place has stresses left, whose work on its displacement cancels.
  virtual_work_scale_ = here[4] + std::abs(internal_work) + bulk_dissipation_;
  if (scene_.stabilization) { // a load that it bears alone leaves nothing but rounding of the other terms
    PetscScalar resisted = 0.0;
    AMT_PETSC(VecDot(viscous_, unknowns, &resisted));
    virtual_work_scale_ += std::abs(resisted);
  }
  AMT_PETSC(VecCopy(external_, external_old_));
  AMT_PETSC(VecCopy(unknowns, unknowns_old_));
}

double Ledger::dissipated_energy() const {
  return std::accumulate(dissipated_.begin(), dissipated_.end(), bulk_dissipation_);
}

void Ledger::save(Checkpoint& checkpoint) const {
  const auto& mesh = scene_.mesh;
  NodalArray forces{mesh.dim, std::vector<double>(std::size_t(mesh.num_local()) * mesh.dim)};
  scene_.layout->gather_displacement(external_old_, forces.values); // that of a tied group at all its nodes
  checkpoint.nodal["external_force"] = std::move(forces);
  checkpoint.global["work"] = {external_work_, work_uncertainty_, stored_energy_};
  checkpoint.global["dissipated"] = dissipated_;
  if (scene_.stabilization) {
    NodalArray viscous{mesh.dim, std::vector<double>(std::size_t(mesh.num_local()) * mesh.dim)};
    scene_.layout->gather_displacement(viscous_old_, viscous.values);
    checkpoint.nodal["viscous_force"] = std::move(viscous);
    checkpoint.global["artificial_work"] = {artificial_work_};
  }
  auto& rigid = checkpoint.global["rigid_masters"];
  for (std::size_t i = 0; i < rigid_force_old_.size(); ++i) {
    rigid.insert(rigid.end(), rigid_force_old_[i].begin(), rigid_force_old_[i].end());
    rigid.insert(rigid.end(), rigid_shift_old_[i].begin(), rigid_shift_old_[i].end());
  }
}

void Ledger::restore(const Checkpoint& checkpoint, Vec unknowns) {
  opened_ = true;
  scene_.layout->put_displacement(checkpoint.nodal.at("external_force").values, external_old_);
  bubbles_old_ = scene_.bulk->loaded_bubbles(scene_.problem->state_at(unknowns));
  AMT_PETSC(VecCopy(unknowns, unknowns_old_));
  const auto& work = checkpoint.global.at("work");
  external_work_ = work.at(0);
  work_uncertainty_ = work.at(1);
  stored_energy_ = work.at(2);
  bulk_dissipation_ = scene_.bulk_dissipation(unknowns);
  dissipated_ = checkpoint.global.at("dissipated");
  if (scene_.stabilization && checkpoint.global.contains("artificial_work")) {
    scene_.layout->put_displacement(checkpoint.nodal.at("viscous_force").values, viscous_old_);
    artificial_work_ = checkpoint.global.at("artificial_work").at(0);
  }
  const auto& rigid = checkpoint.global.at("rigid_masters");
  for (std::size_t i = 0; i < rigid_force_old_.size(); ++i) {
    std::copy_n(rigid.begin() + 6 * static_cast<std::ptrdiff_t>(i), 3, rigid_force_old_[i].begin());
    std::copy_n(rigid.begin() + 6 * static_cast<std::ptrdiff_t>(i) + 3, 3, rigid_shift_old_[i].begin());
  }
}

} // namespace amontons
