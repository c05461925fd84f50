#include "check.hpp"

#include "base/error.hpp"
#include "solve/solver_choice.hpp"
#include "validate.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <set>
#include <sstream>

namespace amontons {

namespace {

/// Unknowns after `refine` uniform refinements, which multiply cells (and nearly so nodes) by 2^dim each.
struct Unknowns {
  double displacement = 0.0;
  double multipliers = 0.0;
  double total() const { return displacement + multipliers; }
};

Unknowns count_unknowns(const Deck& deck, const RawMesh& raw) {
  const std::set<std::int64_t> nodes(raw.cell_nodes.begin(), raw.cell_nodes.end());
  Unknowns count;
  count.displacement = double(raw.dim) * double(nodes.size()) * std::exp2(raw.dim * deck.mesh.refine);
  for (const auto& contact : deck.contact) {
    if (!std::holds_alternative<SemismoothDeck>(contact.enforce) || is_condensed(contact.enforce)) continue;
    std::set<std::int64_t> vertices;
    for (const auto& sub : raw.subs)
      if (raw.groups[sub.group].name == contact.slave.value && raw.groups[sub.group].dim == raw.dim - 1)
        vertices.insert(sub.nodes.begin(), sub.nodes.begin() + num_vertices(sub.type));
    const double fields = contact.friction ? 1.0 + raw.dim : 1.0;
    count.multipliers += fields * double(vertices.size()) * std::exp2((raw.dim - 1) * deck.mesh.refine);
  }
  return count;
}

/// Bytes of the direct solver's factor by the growth law of nested dissection, N log2 N in 2D and N^(4/3) in 3D. The 3D
/// factor is that of measured symmetric factorizations of trilinear hexahedra (4.7 GB at 311k unknowns), the 2D one
/// that of a nine-point grid (31/4 n log2 n entries for n nodes) with 2 x 2 blocks.
double factor_bytes(int dim, double unknowns) {
  const double n = std::max(unknowns, 2.0);
  return dim == 2 ? 8.0 * 15.5 * n * std::log2(n) : 220.0 * std::pow(n, 4.0 / 3.0);
}

/// Matrix rows of 2D and 3D elements of first order hold about 18 and 81 entries of 12 bytes; twice that for order 2.
double matrix_bytes(const RawMesh& raw, double unknowns) {
  return unknowns * (raw.dim == 2 ? 18.0 : 81.0) * 12.0 * raw.order;
}

/// Does the solver that the program chooses for this deck factorize nothing large?
bool goes_to_multigrid(const Deck& deck, const RawMesh& raw, double unknowns) {
  const auto displacements_only = [](const auto& contact) {
    return std::holds_alternative<UzawaDeck>(contact.enforce) || std::holds_alternative<PenaltyDeck>(contact.enforce);
  };
  return raw.dim == 3 && unknowns > krylov_from_3d &&
         std::all_of(deck.contact.begin(), deck.contact.end(), displacements_only);
}

/// Two digits are more than the estimate is worth.
std::string memory_text(double bytes) {
  std::ostringstream text;
  text << std::fixed;
  if (bytes < 100e6)
    text << std::setprecision(0) << std::max(1.0, bytes / 1e6) << " MB";
  else
    text << std::setprecision(1) << bytes / 1e9 << " GB";
  return text.str();
}

/// What a run needs, in words. Multigrid: lib/solve/README.md.
std::string describe_memory(const Deck& deck, const RawMesh& raw, double unknowns) {
  const double matrix = matrix_bytes(raw, unknowns);
  std::ostringstream text;
  if (goes_to_multigrid(deck, raw, unknowns))
    text << memory_text(2.2 * matrix) << " in all with multigrid (matrix " << memory_text(matrix)
         << ", a little more than that for the rest)";
  else
    text << memory_text(factor_bytes(raw.dim, unknowns) + matrix)
         << " in all with the direct solver (order of magnitude: factor "
         << (raw.dim == 2 ? "124 bytes x N log2 N" : "220 bytes x N^(4/3)") << ", matrix " << memory_text(matrix)
         << ")";
  return text.str();
}

const char* enforce_name(const EnforceDeck& enforce) {
  const char* const names[] = {"semismooth", "uzawa", "penalty", "vi"}; // in the order of EnforceDeck
  return is_condensed(enforce) ? "semismooth, dual basis" : names[enforce.index()];
}

const char* space_text(Space space) {
  switch (space) {
  case Space::PlaneStrain:
    return "plane strain";
  case Space::PlaneStress:
    return "plane stress";
  case Space::Axisymmetric:
    return "axisymmetric";
  case Space::Solid:
    return "3D solid";
  }
  return "";
}

void describe_groups(std::ostream& out, const RawMesh& raw) {
  const char* const kinds[] = {"points", "curves", "surfaces", "volumes"};
  for (int dim = raw.dim; dim >= 0; --dim)
    for (const auto& group : raw.groups)
      if (group.dim == dim)
        out << "  group    " << group.name << " (" << kinds[dim] << ", " << group.num_elements
            << (group.num_elements == 1 ? " element)\n" : " elements)\n");
}

void describe_effects(std::ostream& out, const Deck& deck) {
  const bool finite = deck.kinematics == Kinematics::Finite;
  const bool plastic = std::any_of(deck.materials.begin(), deck.materials.end(), [](const auto& material) {
    return std::holds_alternative<ElasticPlastic>(material.second.value.law);
  });
  std::vector<std::string> on = {finite ? "finite strain" : "linear elasticity"}, off;
  (plastic ? on : off).push_back("plasticity");
  (deck.contact.empty() ? off : on).push_back("contact");
  (deck.body_force.empty() ? off : on).push_back("body force");
  const bool friction =
      std::any_of(deck.contact.begin(), deck.contact.end(), [](const auto& pair) { return pair.friction.has_value(); });
  (friction ? on : off).push_back("friction");
  if (!finite) off.emplace_back("finite strain");
  off.emplace_back("inertia");
  out << "  on       " << join_names(on) << "\n  off      " << join_names(off) << "\n";
  for (const auto& contact : deck.contact) {
    const auto* master = std::get_if<Located<std::string>>(&contact.master.value);
    out << "  contact  " << contact.name.value << ": " << contact.slave.value
        << (meets_itself(contact) ? " with themselves"
            : master              ? " on " + master->value
                                  : " on a rigid shape")
        << ", " << enforce_name(contact.enforce) << "\n";
  }
  if (!deck.contact.empty()) out << "  enforce  " << enforce_advice() << "\n";
}

} // namespace

std::string check_report(MPI_Comm comm, const std::string& deck_path) {
  const auto deck = read_deck(comm, deck_path);
  const auto raw = read_checked_mesh(comm, deck);
  std::ostringstream out;
  out << deck.path << (deck.title.empty() ? "" : ": " + deck.title) << "\n"
      << "  space    " << space_text(deck.space)
      << (deck.kinematics == Kinematics::Finite ? ", finite strains\n" : ", small strains\n") << "  mesh     "
      << deck.mesh.file.value << ", " << raw.num_cells() << " cells of order " << raw.order;
  if (deck.mesh.refine > 0) out << ", to be refined " << deck.mesh.refine << " times";
  out << "\n";
  describe_groups(out, raw);
  describe_effects(out, deck);
  out << "  steps    ";
  for (const auto& step : deck.steps)
    out << step.name.value << " to t = " << step.to << "; ";
  const auto unknowns = count_unknowns(deck, raw);
  out << "\n  unknowns " << std::fixed << std::setprecision(0) << unknowns.total() << " (" << unknowns.displacement
      << " displacement, " << unknowns.multipliers << " contact tractions)\n"
      << "  memory   about " << describe_memory(deck, raw, unknowns.total()) << ", and about 100 MB for each rank\n"
      << "The deck fits its mesh; nothing was solved or written.\n";
  return out.str();
}

} // namespace amontons
