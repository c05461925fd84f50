#include "report.hpp"

#include "base/log.hpp"
#include "base/timer.hpp"
#include "math/tensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

const char* const axes[] = {"x", "y", "z"};

std::string enforcement_name(const ContactPair& pair) {
  if (std::holds_alternative<Penalty>(pair.enforcement)) return "penalty";
  if (std::holds_alternative<BoundConstraint>(pair.enforcement)) return "vi";
  if (std::holds_alternative<CondensedSemismooth>(pair.enforcement)) return "semismooth, dual basis";
  return std::holds_alternative<Uzawa>(pair.enforcement) ? "uzawa" : "semismooth";
}

bool wants_field(const Scene& scene, const std::string& name) {
  const auto& fields = scene.deck.output.fields;
  return std::any_of(fields.begin(), fields.end(), [&](const auto& field) { return field.value == name; });
}

void add_friction_fields(const ContactSamples& sample, PointFields& points) {
  std::vector<double> shear, slip;
  for (std::size_t q = 0; q < sample.size(); ++q) {
    shear.insert(shear.end(), sample.shear[q].begin(), sample.shear[q].end());
    slip.insert(slip.end(), sample.slip[q].begin(), sample.slip[q].end());
  }
  points.fields.push_back({.name = "shear", .components = 3, .values = std::move(shear)});
  points.fields.push_back({.name = "slip", .components = 3, .values = std::move(slip)});
  points.fields.push_back({.name = "accumulated_slip", .values = sample.accumulated_slip});
  points.fields.push_back({.name = "tau_c", .values = sample.tau_c});
  for (std::size_t k = 0; k < sample.states.size(); ++k)
    points.fields.push_back({.name = sample.state_names[k], .values = sample.states[k]});
}

bool has_rigid_master(const PairReport& contact) { return std::holds_alternative<RigidMaster>(contact.pair().master); }

} // namespace

std::vector<std::string> history_columns(const Scene& scene, const Ledger& ledger) {
  std::vector<std::string> columns = {"time"};
  const int d = scene.mesh.dim;
  for (const auto& reaction : ledger.reactions())
    for (int c = 0; c < d; ++c)
      columns.push_back("reaction_" + reaction.group + "_" + axes[c]);
  for (const auto& tied : scene.layout->tied())
    columns.push_back("displacement_" + tied.group + "_" + axes[tied.component]);
  for (const auto* contact : scene.contacts)
    for (int c = 0; has_rigid_master(*contact) && c < d; ++c)
      columns.push_back("displacement_" + contact->pair().name + "_master_" + axes[c]);
  for (const auto* contact : scene.contacts) {
    const auto prefix = "contact_" + contact->pair().name + "_";
    for (int c = 0; c < d; ++c)
      columns.push_back(prefix + "force_" + axes[c]);
    for (const char* quantity : {"area", "max_pressure", "penetration"})
      columns.push_back(prefix + quantity);
    if (!contact->pair().friction) continue;
    for (const char* quantity : {"stick_area", "slip_area", "open_area", "dissipation", "dissipation_total"})
      columns.push_back(prefix + quantity);
    for (int c = 0; c < d; ++c)
      columns.push_back(prefix + "shear_" + axes[c]);
  }
  if (measures_path(scene.deck)) columns.emplace_back("path_error");
  if (scene.stabilization) columns.emplace_back("energy_artificial");
  for (const char* quantity : {"energy_stored", "energy_dissipated", "energy_external_work", "newton", "linear",
                               "outer", "remedy", "residual", "certified"})
    columns.emplace_back(quantity);
  return columns;
}

std::vector<double> history_row(Scene& scene, const Ledger& ledger, const std::vector<ContactTotals>& totals,
                                const IncrementReport& report) {
  std::vector<double> row = {report.time};
  const int d = scene.mesh.dim;
  for (const auto& reaction : ledger.reactions())
    row.insert(row.end(), reaction.force.begin(), reaction.force.begin() + d);
  for (std::size_t i = 0; i < scene.layout->tied().size(); ++i)
    row.push_back(ledger.tied_displacements()[i]);
  for (const auto* contact : scene.contacts)
    if (has_rigid_master(*contact)) {
      const auto shift = contact->rigid_shift();
      row.insert(row.end(), shift.begin(), shift.begin() + d);
    }
  for (std::size_t i = 0; i < totals.size(); ++i) {
    const auto& pair = totals[i];
    row.insert(row.end(), pair.force.begin(), pair.force.begin() + d);
    row.insert(row.end(), {pair.area, pair.max_pressure, pair.largest_penetration});
    if (!scene.contacts[i]->pair().friction) continue;
    row.insert(row.end(),
               {pair.stick_area, pair.slip_area, pair.open_area, pair.dissipation, ledger.dissipated_by_pair()[i]});
    row.insert(row.end(), pair.tangential_force.begin(), pair.tangential_force.begin() + d);
  }
  if (measures_path(scene.deck)) row.push_back(report.path_error);
  if (scene.stabilization) row.push_back(ledger.artificial_work());
  row.insert(row.end(), {ledger.stored_energy(), ledger.dissipated_energy(), ledger.external_work(),
                         double(report.outcome.newton), double(report.outcome.linear), double(report.outcome.outer),
                         double(report.outcome.rung), report.outcome.residual, report.certified ? 1.0 : 0.0});
  return row;
}

void write_fields(Scene& scene, FieldsWriter& writer, Vec unknowns, const std::vector<ContactSamples>& samples) {
  const auto state = scene.problem->state_at(unknowns);
  const std::vector<double> displacement(state.displacement.begin(), state.displacement.end());
  FieldsStep step;
  step.time = state.time;
  if (wants_field(scene, "displacement"))
    step.nodal.push_back({.name = "displacement", .kind = FieldKind::Vector, .values = displacement});
  NodalStress recovered;
  std::vector<double> mises;
  if (wants_field(scene, "stress")) {
    recovered = nodal_stress(*scene.bulk, scene.mesh, state);
    const std::size_t components = scene.mesh.dim == 2 ? strain_size<2> : strain_size<3>;
    for (std::size_t at = 0; at < recovered.stress.size(); at += components) {
      mises.push_back(von_mises(std::span(recovered.stress).subspan(at, components)));
      // Fields hold tensor components: half of the engineering shear strains.
      for (std::size_t shear = 3; shear < components; ++shear)
        recovered.strain[at + shear] *= 0.5;
    }
    step.nodal.push_back({.name = "stress", .kind = FieldKind::SymmetricTensor, .values = recovered.stress});
    step.nodal.push_back({.name = "strain", .kind = FieldKind::SymmetricTensor, .values = recovered.strain});
    step.nodal.push_back({.name = "von_mises", .kind = FieldKind::Scalar, .values = mises});
    const auto names = scene.bulk->scalar_names();
    for (std::size_t k = 0; k < names.size(); ++k)
      step.nodal.push_back({.name = names[k], .kind = FieldKind::Scalar, .values = recovered.scalars[k]});
  }
  if (wants_field(scene, "contact"))
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto& pair = scene.contacts[i]->pair();
      const auto& sample = samples[i];
      step.surfaces.push_back(
          {.name = pair.name,
           .surface = pair.slave,
           .fields = {{.name = "pressure", .nodes = sample.nodes, .values = sample.nodal_pressure}}});
      PointFields points{.name = pair.name, .places = sample.place, .fields = {}};
      std::vector<double> gap, status, normals;
      for (std::size_t q = 0; q < sample.size(); ++q) {
        gap.push_back(sample.gap[q] < 1e299 ? sample.gap[q] : std::numeric_limits<double>::quiet_NaN());
        status.push_back(static_cast<double>(sample.status[q]));
        normals.insert(normals.end(), sample.normal[q].begin(), sample.normal[q].end());
      }
      points.fields = {{.name = "pressure", .values = sample.pressure},
                       {.name = "gap", .values = std::move(gap)},
                       {.name = "status", .values = std::move(status)},
                       {.name = "weight", .values = sample.weight},
                       {.name = "normal", .components = 3, .values = std::move(normals)}};
      if (sample.has_friction) add_friction_fields(sample, points);
      step.points.push_back(std::move(points));
    }
  writer.write(step);
}

nlohmann::ordered_json resources(MPI_Comm comm, double wall_seconds) {
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  nlohmann::ordered_json phases, growth;
  double timed = 0.0;
  // Ranks go through the same phases; one that a rank never entered counts as zero there.
  for (const char* phase :
       {"mesh", "set up", "search", "pattern", "bulk", "loads", "support", "stabilization", "contact", "matrix",
        "factorization", "linear solver", "certificate", "output", "error estimate"}) {
    const auto of_phase = [phase](const std::map<std::string, double>& figures) {
      const auto found = figures.find(phase);
      return found == figures.end() ? 0.0 : found->second;
    };
    double sums[2] = {of_phase(PhaseTimer::of_run().seconds()), of_phase(PhaseTimer::of_run().memory_growth())};
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm);
    if (sums[0] > 0.0) phases[phase] = sums[0] / ranks;
    if (sums[1] > 0.0) growth[phase] = sums[1];
    timed += sums[0] / ranks;
  }
  phases["rest"] = std::max(0.0, wall_seconds - timed);
  double sums[2] = {cpu_seconds(), peak_memory()};
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm);
  return {{"wall_seconds", wall_seconds},
          {"cpu_seconds", sums[0]},
          {"peak_memory_bytes", sums[1]},
          {"memory_growth_bytes", growth},
          {"phase_seconds", phases}};
}

nlohmann::ordered_json contact_results(const Scene& scene, const Ledger& ledger,
                                       const std::vector<ContactTotals>& totals) {
  nlohmann::ordered_json results;
  for (std::size_t i = 0; i < totals.size(); ++i) {
    const auto& pair = totals[i];
    auto& json = results[scene.contacts[i]->pair().name];
    json = {{"force", pair.force},
            {"area", pair.area},
            {"max_pressure", pair.max_pressure},
            {"largest_penetration", pair.largest_penetration}};
    if (scene.contacts[i]->pair().friction)
      json["friction"] = {{"force", pair.tangential_force},
                          {"stick_area", pair.stick_area},
                          {"slip_area", pair.slip_area},
                          {"open_area", pair.open_area},
                          {"dissipation", ledger.dissipated_by_pair()[i]}};
  }
  return results;
}

nlohmann::ordered_json describe_remedies(const std::vector<Ladder::Use>& uses) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < uses.size(); ++i)
    if (uses[i].tried > 0) json[name_of(remedies()[i])] = {{"tried", uses[i].tried}, {"helped", uses[i].helped}};
  return json;
}

nlohmann::ordered_json describe_trouble(const Trouble& trouble) {
  nlohmann::ordered_json json;
  json["cycle_length"] = trouble.cycle;
  json["residual"] = trouble.residual;
  json["largest_status_change"] = trouble.largest_change;
  json["flipping_points"] = {{"count", trouble.num_flipping}, {"first", nlohmann::ordered_json::array()}};
  for (const auto& point : trouble.points)
    json["flipping_points"]["first"].push_back({{"pair", point.name}, {"place", point.place}});
  json["free_motions"] = nlohmann::ordered_json::array();
  for (const auto& motion : trouble.free)
    json["free_motions"].push_back({{"body", motion.body}, {"direction", motion.direction}});
  return json;
}

nlohmann::ordered_json describe_scene(const Scene& scene) {
  const auto& mesh = scene.mesh;
  std::int64_t cells = 0;
  for (const auto& block : mesh.blocks)
    cells += block.size();
  MPI_Allreduce(MPI_IN_PLACE, &cells, 1, MPI_INT64_T, MPI_SUM, mesh.comm);
  nlohmann::ordered_json pairs = nlohmann::ordered_json::array();
  for (const auto* contact : scene.contacts) {
    const auto& pair = contact->pair();
    const auto* master = std::get_if<std::string>(&pair.master);
    pairs.push_back({{"name", pair.name},
                     {"slave", pair.slave},
                     {"master", master ? *master : "rigid shape"},
                     {"enforce", enforcement_name(pair)},
                     {"alpha", pair.alpha},
                     {"search_distance", pair.search_distance}});
  }
  nlohmann::ordered_json effects;
  effects["contact"] = !scene.contacts.empty();
  effects["friction"] = std::any_of(scene.contacts.begin(), scene.contacts.end(),
                                    [](const auto* contact) { return contact->pair().friction.has_value(); });
  effects["finite_kinematics"] = scene.deck.kinematics == Kinematics::Finite;
  effects["nonlinear_materials"] = !scene.bulk->tangent_is_constant();
  effects["inertia"] = false;
  effects["unknown_multipliers"] = scene.layout->num_extra() > 0;
  effects["outer_loop"] = scene.multipliers != nullptr;
  effects["bounded_unknowns"] = scene.bounds != nullptr;
  effects["condensed_multipliers"] = scene.conditions != nullptr;
  effects["loads"] = scene.loads != nullptr;
  effects["stabilization"] = scene.stabilization != nullptr;
  effects["follower_pressure"] = scene.follower != nullptr;
  nlohmann::ordered_json json;
  json["dim"] = mesh.dim;
  json["order"] = mesh.order;
  json["nodes"] = mesh.num_global;
  json["cells"] = cells;
  json["unknowns"] = {{"displacement", mesh.num_global * mesh.dim}, {"multipliers", scene.layout->num_extra()}};
  json["effects"] = effects;
  json["bodies_held_by_contact_alone"] = scene.floating;
  json["contact"] = pairs;
  return json;
}

} // namespace amontons
