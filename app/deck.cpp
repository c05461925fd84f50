// The declaration of the deck: every key with its type, unit, range, default (that of the struct) and sentence.
#include "deck.hpp"

#include "base/error.hpp"
#include "deck/rule.hpp"
#include "deck_checks.hpp"
#include "mesh/mesh.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace amontons {

namespace {

const std::string group_meaning = "name of a physical group of the mesh";

ObjectRule<VectorDeck> components(const std::string& unit) {
  const auto component = [](std::size_t i) {
    return [i](auto& vector) -> auto& { return vector[i]; };
  };
  ObjectRule<VectorDeck> rule;
  rule.optional("x", component(0), expression(unit), "Component along x (the radius when axisymmetric).")
      .optional("y", component(1), expression(unit), "Component along y (the axis when axisymmetric).")
      .optional("z", component(2), expression(unit), "Component along z; with space: solid only.");
  return rule;
}

ObjectRule<MeshDeck> mesh_rule() {
  ObjectRule<MeshDeck> rule;
  rule.required("file", &MeshDeck::file, text("file, relative to the deck's folder"),
                "The mesh: a .geo file, meshed by gmsh, or a .msh file (format 2.2 or 4.1), read as it is.")
      .optional("parameters", &MeshDeck::parameters, map_of("name of a DefineConstant of the .geo", number("any")),
                "Values for the constants that the .geo file declares with DefineConstant.")
      .optional("order", &MeshDeck::order, integer(Range::between(1, 2)),
                "Polynomial order of the elements. When absent: 1 for a .geo file, the file's own for a .msh file.")
      .optional("refine", &MeshDeck::refine, integer(Range::between(0, 8)),
                "Uniform refinements after distribution; each halves the size of all cells.");
  return rule;
}

WordRule<Space> space_rule() {
  WordRule<Space> rule;
  rule.word("plane_strain", Space::PlaneStrain, "2D, no strain out of the plane, forces per unit thickness.")
      .word("plane_stress", Space::PlaneStress, "2D, no stress out of the plane, forces per unit thickness.")
      .word("axisymmetric", Space::Axisymmetric, "2D, x is the radius and y the axis, forces of the full turn.")
      .word("solid", Space::Solid, "3D.");
  return rule;
}

WordRule<Kinematics> kinematics_rule() {
  WordRule<Kinematics> rule;
  rule.word("small", Kinematics::Small,
            "Small strains and rotations, below a few per cent; contact normals and areas of the reference "
            "configuration.")
      .word("finite", Kinematics::Finite,
            "Strains and rotations of any size: equilibrium of the deformed body. Tractions and body forces are per "
            "reference area and volume and keep their direction; pressure acts on the deformed surface.");
  return rule;
}

ObjectRule<MaterialDeck> material_rule() {
  ObjectRule<MaterialDeck> rule;
  rule.choice(&MaterialDeck::law, bulk_material_rule())
      .optional("density", &MaterialDeck::density, number("mass / length^3", Range::at_least(0)),
                "Mass density; body_force expressions know it as rho. Also tells whether inertia may be left out.")
      .optional(
          "yield_stress", &MaterialDeck::yield_stress, number("stress", Range::above(0)),
          "Stress at which the material yields; changes nothing, but the summary then tells whether it was reached.")
      .optional(
          "heat_capacity", &MaterialDeck::heat_capacity, number("energy / (mass temperature)", Range::above(0)),
          "Specific heat capacity; changes nothing, but the summary then tells how warm friction makes the bodies.");
  return rule;
}

ObjectRule<BoundaryDeck> boundary_rule() {
  ObjectRule<BoundaryDeck> rule;
  rule.required("on", &BoundaryDeck::on, text(group_meaning), "The physical group that the conditions act on.")
      .optional("displacement", &BoundaryDeck::displacement, components("length"),
                "Prescribed displacement; components that are left out are free.")
      .optional("traction", &BoundaryDeck::traction, components("force / area"), "Force per reference area.")
      .optional("pressure", &BoundaryDeck::pressure, expression("force / area"),
                "Pressure on the surface; positive pushes into the body. In finite kinematics it follows the surface.")
      .optional("resultant", &BoundaryDeck::resultant, components("force"),
                "Total force on the group, which moves as one in that direction.");
  return rule;
}

TaggedRule<MasterDeck> master_rule() {
  const auto point = [] { return list_of(number("length"), 2, 3); };
  const auto direction = [] { return list_of(number("1"), 2, 3); };
  const std::string moves = "Displacement of the rigid shape; zero where left out.";
  ObjectRule<PlaneDeck> plane;
  plane.required("point", &PlaneDeck::point, point(), "A point of the plane: [x, y] or [x, y, z].")
      .required("normal", &PlaneDeck::normal, direction(),
                "Direction out of the rigid body, towards the deformable one; of any length but zero.")
      .optional("displacement", &PlaneDeck::displacement, components("length"), moves);
  ObjectRule<SphereDeck> sphere;
  sphere.required("centre", &SphereDeck::centre, point(), "Centre: [x, y] or [x, y, z]; on the axis when axisymmetric.")
      .required("radius", &SphereDeck::radius, number("length", Range::above(0)), "Radius.")
      .optional("displacement", &SphereDeck::displacement, components("length"), moves)
      .not_yet("inside", "A cavity must be meshed as a body of its own with a stiff material.");
  ObjectRule<CylinderDeck> cylinder;
  cylinder.required("centre", &CylinderDeck::centre, point(), "A point of the axis: [x, y] or [x, y, z].")
      .optional("axis", &CylinderDeck::axis, direction(),
                "Direction of the axis; with space: solid only, and required there.")
      .required("radius", &CylinderDeck::radius, number("length", Range::above(0)), "Radius.")
      .optional("displacement", &CylinderDeck::displacement, components("length"), moves);
  ObjectRule<CornerDeck> corner;
  corner.required("point", &CornerDeck::point, point(), "A point of the edge as it would be without the rounding.")
      .required("normals", &CornerDeck::normals, list_of(direction(), 2, 2),
                "Directions out of the rigid body of the two faces that meet in the edge.")
      .required("radius", &CornerDeck::radius, number("length", Range::above(0)), "Radius of the rounding.")
      .optional("displacement", &CornerDeck::displacement, components("length"), moves);
  WordRule<BoxPart> part;
  part.word("punch", BoxPart::Punch, "Solid inside the rectangle.")
      .word("die", BoxPart::Die, "Solid outside the rectangle, which is its opening.");
  ObjectRule<RoundedBoxDeck> box;
  box.required("part", &RoundedBoxDeck::part, part, "Which side of the rectangle is solid.")
      .required("point", &RoundedBoxDeck::point, point(), "Middle of the rectangle, in the flat face.")
      .required("normal", &RoundedBoxDeck::normal, direction(), "Direction out of the rigid body at its flat face.")
      .required("side", &RoundedBoxDeck::side, direction(), "Direction across a pair of walls; orthogonal to normal.")
      .required("half_widths", &RoundedBoxDeck::half_widths, list_of(number("length", Range::above(0)), 2, 2),
                "Of the rectangle, along side and across it.")
      .required("corner_radius", &RoundedBoxDeck::corner_radius, number("length", Range::above(0)),
                "Radius of the rectangle's corners; at most the smaller half width, which makes round ends of it.")
      .required("edge_radius", &RoundedBoxDeck::edge_radius, number("length", Range::above(0)),
                "Radius of the edge between face and walls; of a punch at most the corner radius.")
      .optional("displacement", &RoundedBoxDeck::displacement, components("length"), moves);
  TaggedRule<MasterDeck> rule;
  rule.bare(located(text(group_meaning)))
      .tag("plane", plane, "Rigid half-space.")
      .tag("sphere", sphere, "Rigid ball; a disc in plane strain and plane stress.")
      .tag("cylinder", cylinder, "Rigid cylinder of infinite length; a disc in plane strain and plane stress.")
      .tag("corner", corner,
           "Rigid body with two plane faces and a rounded convex edge between them, such as a die or a punch; when "
           "axisymmetric, its turned form: one face a cone, a cylinder or a disc.")
      .tag("rounded_box", box,
           "Rigid punch or die for boxes, with space: solid: a flat face that ends in a rounded edge along a "
           "rectangle with rounded corners, and walls without end.");
  return rule;
}

TaggedRule<EnforceDeck> enforce_rule() {
  const std::string alpha = "Augmentation stiffness in units of (tangent modulus / facet size).";
  ObjectRule<SemismoothDeck> semismooth;
  semismooth.optional("alpha", &SemismoothDeck::alpha, number("1", Range::above(0)),
                      alpha + " Its influence on the solution vanishes with the mesh; larger: smaller gaps between "
                              "nodes, rougher pressure. None with the dual basis.");
  WordRule<MultiplierBasis> basis;
  basis
      .word("nodal", MultiplierBasis::Nodal,
            "Linear on slave facets; unknowns of a saddle-point system, one a node, and as many more as there are "
            "dimensions with friction.")
      .word("dual", MultiplierBasis::Dual,
            "Functions dual to the displacements of the slave, so that every multiplier is what one node is out of "
            "balance by and none is an unknown. Serves all pairs of a deck or none.");
  semismooth.optional("basis", &SemismoothDeck::basis, basis, "What the multipliers are made of.",
                      "S. Hueeber, B. I. Wohlmuth, Comput. Methods Appl. Mech. Engrg. 194 (2005) 3147-3166; "
                      "M. Gitterle et al., Int. J. Numer. Meth. Engng. 84 (2010) 543-571.");
  ObjectRule<UzawaDeck> uzawa;
  uzawa
      .optional("alpha", &UzawaDeck::alpha, number("1", Range::above(0)),
                alpha + " The solution is that of semismooth with the same alpha; larger: fewer outer iterations.")
      .optional("tolerance", &UzawaDeck::tolerance, number("1", Range::above_up_to(0, 0.01)),
                "Relative change of the multipliers at which the outer loop stops.")
      .optional("max_iterations", &UzawaDeck::max_iterations, integer(Range::at_least(1)),
                "Outer iterations after which the increment has failed.");
  ObjectRule<PenaltyDeck> penalty;
  penalty.optional(
      "alpha", &PenaltyDeck::alpha, number("1", Range::above(0)),
      "Penalty stiffness in units of (tangent modulus / facet size); larger: less penetration, but rougher pressure on "
      "coarse meshes and more iterations.");
  TaggedRule<EnforceDeck> rule;
  rule.tag("semismooth", semismooth, "Nodal multipliers solved together with the displacements by one Newton method.",
           "P. Alart, A. Curnier, Comput. Methods Appl. Mech. Engrg. 92 (1991) 353-375.")
      .tag("uzawa", uzawa,
           "Nodal multipliers updated in an outer loop (augmented Lagrangian); displacements only inside.",
           "J. C. Simo, T. A. Laursen, Computers & Structures 42 (1992) 97-116.")
      .tag("penalty", penalty, "Contact traction proportional to the penetration; approximate.",
           "N. Kikuchi, J. T. Oden, Contact Problems in Elasticity, SIAM (1988).")
      .tag("vi", ObjectRule<ViDeck>(),
           "Bounds on the normal motion of dual-basis mortar unknowns, solved as a variational inequality; "
           "frictionless, "
           "displacements only.",
           "B. I. Wohlmuth, R. Krause, SIAM J. Sci. Comput. 25 (2003) 324-347.");
  return rule;
}

/// A surface that meets itself: slave and master in one.
void meet_itself(ContactDeck& contact, ContactSides sides, const Located<std::string>& surface) {
  contact.sides = sides;
  contact.slave = surface;
  contact.master = {MasterDeck(surface), surface.place};
}

/// Takes `self` and `between` for slave and master, of which then neither may stand there.
void settle_sides(const DeckNode& node, ContactDeck& contact, Reading& reading) {
  const DeckNode *self = node.find("self"), *between = node.find("between");
  const auto* itself = self ? self : between;
  for (const char* key : {"slave", "master"}) {
    const auto* other = node.find(key);
    if (!itself && !other)
      reading.fail(node.place, std::string("the key '") + key + "' is missing in " + node.path +
                                   ": a pair has a slave and a master. Add it, or write `self: SURFACE` for a surface "
                                   "that meets itself or `between: all` for all surfaces.");
    if (itself && other)
      reading.fail(other->place, node.path + "." + key + ": with " + (self ? "self" : "between") +
                                     " the surfaces are settled. Remove this key.");
  }
  if (self && between)
    reading.fail(between->place, node.path + ".between: all surfaces include that of self. Remove one of the two.");
  if (!itself) return;
  if (self)
    meet_itself(contact, ContactSides::Itself, contact.slave);
  else
    meet_itself(contact, ContactSides::All, {exterior_name, between->place});
  const bool both_passes =
      std::holds_alternative<PenaltyDeck>(contact.enforce) || std::holds_alternative<UzawaDeck>(contact.enforce);
  if (!both_passes)
    reading.fail(node.find("enforce") ? node.find("enforce")->place : node.place,
                 node.path +
                     ".enforce: a surface that meets itself is slave on both sides of every contact, and of two "
                     "unknown multipliers (or bounds) there only the sum is determined. Use "
                     "`enforce: {penalty: {}}` or `enforce: {uzawa: {}}`.");
  if (std::holds_alternative<SegmentIntegrationDeck>(contact.integration))
    reading.fail(node.find("integration")->place,
                 node.path + ".integration: which facets of a surface meet changes as it folds, so segments cannot be "
                             "cut beforehand. Use `{facet: {order: 6}}`, or a higher order.");
}

ObjectRule<ContactDeck> contact_rule() {
  TaggedRule<decltype(ContactDeck::projection)> projection;
  projection.tag("closest_point", ObjectRule<ClosestPointDeck>(), "The closest point of the master surface.")
      .tag("slave_normal", ObjectRule<SlaveNormalDeck>(), "Along the slave's normal: robust on coarse master facets.");
  ObjectRule<CubicMasterDeck> cubic;
  cubic.optional("crease_angle", &CubicMasterDeck::crease_angle, number("degrees", Range::above_up_to(0, 180)),
                 "Facets that meet at this angle or more (in the reference configuration) keep the edge between them.");
  TaggedRule<decltype(ContactDeck::smoothing)> smoothing;
  smoothing.tag("facets", ObjectRule<FacetedMasterDeck>(), "The facets of the mesh.")
      .tag(
          "cubic", cubic,
          "Cubic facets through the nodes of the mesh (Overhauser's splines, in 3D products of two), whose normal does "
          "not jump: for coarse masters that stand for a round surface, and for large sliding. For a meshed master of "
          "order 1, in 3D of quadrangles, with nodal multipliers. The certificate goes on looking at the facets: "
          "between facets that meet at an angle a it sees gaps and overlaps of a/8 of a facet (a in radians).",
          "P. Wriggers, L. Krstulovic-Opara, J. Korelc, Int. J. Numer. Meth. Engng. 51 (2001) 1469-1495.");
  ObjectRule<FacetIntegrationDeck> facet;
  facet.optional("order", &FacetIntegrationDeck::order, integer(Range::between(1, 40)),
                 "Polynomial degree integrated exactly on a slave facet.");
  ObjectRule<SegmentIntegrationDeck> segment;
  segment.optional("order", &SegmentIntegrationDeck::order, integer(Range::between(1, 40)),
                   "Polynomial degree integrated exactly on each piece of a slave facet.");
  TaggedRule<decltype(ContactDeck::integration)> integration;
  integration
      .tag("facet", facet,
           "Gauss points on the slave facets: cheap, but blind to where master facets end, so a uniform pressure "
           "between "
           "flat surfaces comes across with an error of 1e-3 to 1e-1 at order 4.")
      .tag("segment", segment,
           "Gauss points on the overlaps of slave facets with single master facets: a uniform pressure between flat "
           "surfaces comes across exactly. Take it for accurate pressures between meshes that do not match, above all "
           "where the slave is the coarser side. Costs twice the points in 2D, five times in 3D, a dozen with cells of "
           "order 2; Newton's iterations stay the same. Needs a meshed master.",
           "M. A. Puso, Int. J. Numer. Meth. Engng. 59 (2004) 315-336.");
  WordRule<ContactSides> between;
  between.word("all", ContactSides::All, "All exterior surfaces of all bodies.");
  ObjectRule<ContactDeck> rule;
  rule.required("name", &ContactDeck::name, identifier("name of the pair in the results"), "Names the pair in results.")
      .optional("slave", &ContactDeck::slave, text(group_meaning),
                "The surface that carries quadrature points and multipliers; take the finer or the softer one.")
      .optional("master", &ContactDeck::master, master_rule(), "The surface projected onto, or a rigid shape.")
      .optional("self", &ContactDeck::slave, text(group_meaning),
                "Instead of slave and master: a surface that meets itself. Take the whole skin of a thin body, both "
                "sides of its wall. For penalty and uzawa, with kinematics: finite.",
                "R. A. Sauer, L. De Lorenzis, Comput. Methods Appl. Mech. Engrg. 253 (2013) 369-392.")
      .optional("between", &ContactDeck::sides, between,
                "Instead of slave and master: all bodies with each other and with themselves, no pairing needed. "
                "Contacts are searched for in every iteration. For penalty and uzawa.")
      .optional("enforce", &ContactDeck::enforce, enforce_rule(),
                "How the contact conditions are enforced. " + enforce_advice())
      .optional("projection", &ContactDeck::projection, projection, "How a slave point finds its master point.")
      .optional("smoothing", &ContactDeck::smoothing, smoothing, "What slave points are projected onto.")
      .optional("integration", &ContactDeck::integration, integration, "How the slave surface is integrated over.")
      .optional(
          "search_distance", &ContactDeck::search_distance, number("length", Range::above(0)),
          "How far apart surfaces may be and still be watched. When absent: a tenth of the diagonal of the smaller "
          "surface's bounding box.")
      .optional("friction", &ContactDeck::friction, friction_law_rule(),
                "The law of friction. When absent: no friction, at no cost.")
      .optional("friction_factor", &ContactDeck::friction_factor, expression("1"),
                "Multiplies the friction coefficient at each point (in its reference position) and time; >= 0. Not for "
                "cohesions and shear limits. When absent: 1.")
      .then(settle_sides)
      .check([](const DeckNode& node, const ContactDeck& value, Reading& reading) {
        if (std::holds_alternative<SegmentIntegrationDeck>(value.integration) &&
            !std::holds_alternative<Located<std::string>>(value.master.value))
          reading.fail(node.find("integration")->place,
                       node.path + ".integration: a rigid shape has no facets for segments to be cut by. Use " +
                           "{facet: {order: ...}}.");
        if (value.friction_factor && !value.friction)
          reading.fail(node.place, node.path + " has a friction_factor but no friction. Add `friction: {coulomb: {mu: "
                                               "...}}` or another law, or take the factor out.");
      });
  return rule;
}

ObjectRule<StepDeck> step_rule() {
  ObjectRule<AutoIncrements> automatic;
  const auto fraction = [] { return number("1", Range::above_up_to(0, 1)); };
  automatic.optional("first", &AutoIncrements::first, fraction(), "First increment as a fraction of the step.")
      .optional("smallest", &AutoIncrements::smallest, fraction(),
                "Fraction of the step below which an increment is not cut again: the run ends with status 3.")
      .optional("largest", &AutoIncrements::largest, fraction(), "Largest increment as a fraction of the step.")
      .optional("target_iterations", &AutoIncrements::target_iterations, integer(Range::at_least(1)),
                "Newton iterations at which the increment is kept; fewer make it grow, more make it shrink.")
      .optional("path_tolerance", &AutoIncrements::path_tolerance, number("1", Range::above_up_to(0, 0.5)),
                "Each increment is solved whole and in two halves, which are kept. How far they differ (displacement, "
                "contact pressure and shear, relative to the largest so far), summed over the step, stays below this "
                "number; the part of the contact area with another status, in each increment.",
                "E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I (1993), II.4.")
      .check([](const DeckNode& node, const AutoIncrements& value, Reading& reading) {
        if (value.smallest > value.first || value.first > value.largest)
          reading.fail(node.place, node.path + " must have smallest <= first <= largest, but has " +
                                       number_text(value.smallest) + ", " + number_text(value.first) + ", " +
                                       number_text(value.largest) + ".");
      });
  TaggedRule<IncrementsDeck> increments;
  increments.bare(integer(Range::at_least(1)))
      .tag("auto", automatic, "Increments chosen by Newton's effort, and by the path error where it has a tolerance.");
  ObjectRule<StepDeck> rule;
  rule.required("name", &StepDeck::name, identifier("name of the step in the results"), "Names the step.")
      .required("to", &StepDeck::to, number("time", Range::above(0)),
                "Time at the end of the step; the first step begins at 0, each other one where the one before it ends.")
      .optional("increments", &StepDeck::increments, increments, "Number of equal increments, or {auto: {...}}.");
  return rule;
}

ObjectRule<FigureDeck> figure_rule() {
  WordRule<int> component;
  component.word("x", 0, "Along x; in axisymmetric space the radius.")
      .word("y", 1, "Along y; in axisymmetric space the axis.")
      .word("z", 2, "Along z, in solid space.");
  ObjectRule<FigureDeck> rule;
  rule.required("of", &FigureDeck::of, text(group_meaning), "The physical group whose nodes' mean displacement it is.")
      .required("component", &FigureDeck::component, component, "Which component.");
  return rule;
}

ObjectRule<AdaptDeck> adapt_rule() {
  WordRule<AdaptQuantity> quantity;
  quantity
      .word("peak_pressure", AdaptQuantity::PeakPressure,
            "Largest pressure of a contact pair; its error is judged by how it changes from pass to pass.")
      .word("force", AdaptQuantity::Force, "Contact force of a pair; judged likewise.")
      .word("energy", AdaptQuantity::Energy,
            "Stored energy of all bodies; judged by the square of the error in the energy norm.")
      .word("energy_norm", AdaptQuantity::EnergyNorm,
            "Error of the stress everywhere, in the energy norm; judged by recovery.");
  ObjectRule<AdaptDeck> rule;
  rule.optional("target_error", &AdaptDeck::target_error, number("1", Range::above_up_to(0, 0.5)),
                "Relative error of the quantity at which no finer mesh is made.")
      .optional("quantity", &AdaptDeck::quantity, quantity, "What is to be accurate.")
      .optional("pair", &AdaptDeck::pair, text("name of a contact pair"),
                "The pair of peak_pressure and force; may be left out where the deck has one pair.")
      .optional("max_unknowns", &AdaptDeck::max_unknowns, number("1", Range::above(0)),
                "No mesh with more displacement and multiplier unknowns is solved on.")
      .optional("max_passes", &AdaptDeck::max_passes, integer(Range::between(1, 30)),
                "Meshes, the first one counted. 1: the first mesh as adaptive meshing would make it.");
  return rule;
}

TaggedRule<StabilizationDeck> stabilization_rule() {
  ObjectRule<ViscousDeck> viscous;
  viscous.optional("ratio", &ViscousDeck::ratio, number("1", Range::above(0)),
                   "Force against a steady motion over the whole run, relative to the elastic forces of a body "
                   "stretched as far.");
  TaggedRule<StabilizationDeck> rule;
  rule.tag("viscous", viscous,
           "Forces against the velocity of every node: past a limit point the bodies creep to where they are in "
           "equilibrium again. Take the smallest ratio that gets across; with a ratio ten times as small the results "
           "should stay the same.");
  return rule;
}

ObjectRule<CertificateDeck> certificate_rule() {
  const auto tolerance = [] { return number("1", Range::above_up_to(0, 1)); };
  ObjectRule<CertificateDeck> rule;
  rule.optional("penetration", &CertificateDeck::penetration, tolerance(), "Largest penetration / local facet size.")
      .optional("tension", &CertificateDeck::tension, tolerance(),
                "Largest tensile contact traction / largest pressure.")
      .optional(
          "complementarity", &CertificateDeck::complementarity, tolerance(),
          "Sum of |pressure| |gap| / (total contact force x facet size); also the part of the force that may act where "
          "points have slid off their master (left_master).")
      .optional("balance", &CertificateDeck::balance, tolerance(), "Force and moment out of balance / force scale.")
      .optional("energy", &CertificateDeck::energy, tolerance(), "Violation of the energy bounds / external work.")
      .optional("friction", &CertificateDeck::friction, tolerance(),
                "Shear traction off the friction law's limit / largest limit; negative part of the frictional work.")
      .optional(
          "slip", &CertificateDeck::slip, tolerance(),
          "Tangential motion of the surfaces that is not the slip claimed, weighted by the shear traction / largest "
          "displacement increment in the scene.")
      .optional("volume_ratio", &CertificateDeck::volume_ratio, number("1", Range::between(0, 0.99)),
                "Smallest volume ratio det F allowed.")
      .optional("artificial", &CertificateDeck::artificial, tolerance(),
                "Work that `stabilization` takes / external work.");
  return rule;
}

ObjectRule<OutputDeck> output_rule() {
  WordRule<std::string> field;
  field.word("displacement", "displacement", "Displacement of the nodes.")
      .word("stress", "stress", "Stress and von Mises stress.")
      .word("contact", "contact", "Pressure, gap and status on the contact surfaces.");
  ObjectRule<OutputDeck> rule;
  rule.optional("directory", &OutputDeck::directory, text("folder"),
                "Where results go, from the folder that the program runs in. When absent: results/<deck name>.")
      .optional("every", &OutputDeck::every, integer(Range::at_least(1)),
                "Fields are written at each so many accepted increments, and at the end of each step.")
      .optional("fields", &OutputDeck::fields, list_of(located(Rule<std::string>(field))), "Which fields are written.")
      .not_yet("history", "history.csv always holds reactions and the resultants of every contact pair.");
  return rule;
}

/// Body forces know the density of their body's material as rho.
void tell_densities(const Deck& deck, Reading& reading) {
  for (const auto& [body, material] : deck.bodies) {
    const auto found = deck.materials.find(material.value);
    if (found == deck.materials.end()) continue;
    auto& names = reading.entry_names[body];
    if (found->second.value.density > 0)
      names.constants["rho"] = found->second.value.density;
    else
      names.missing["rho"] = "Give material '" + material.value + "' a density to use rho.";
  }
}

Rule<Deck> deck_rule() {
  ObjectRule<Deck> rule;
  rule.optional("constants", &Deck::constants, constants_table(),
                "Numbers with names, for all other numbers and expressions; each may use those above it.")
      .optional("title", &Deck::title, text(""), "One line for results and plots.")
      .required("mesh", &Deck::mesh, mesh_rule(), "The mesh of all bodies.")
      .required("space", &Deck::space, space_rule(), "Dimension and kind of the problem.")
      .optional("kinematics", &Deck::kinematics, kinematics_rule(), "Small or finite strains.")
      .required("materials", &Deck::materials,
                map_of("name of the material", located(Rule<MaterialDeck>(material_rule())), 1), "Materials by name.")
      .required("bodies", &Deck::bodies, map_of("physical group of cells", located(text("name of a material")), 1),
                "The material of each body; a body is a physical group of cells.")
      .then([](const DeckNode&, Deck& deck, Reading& reading) { tell_densities(deck, reading); })
      .optional("boundary", &Deck::boundary, list_of(Rule<BoundaryDeck>(boundary_rule())), "Boundary conditions.")
      .optional("body_force", &Deck::body_force,
                map_of("body", located(Rule<VectorDeck>(components("force / volume")))), "Force per volume of bodies.")
      .optional("contact", &Deck::contact, list_of(Rule<ContactDeck>(contact_rule())),
                "Pairs of surfaces that may touch.")
      .required("steps", &Deck::steps, list_of(Rule<StepDeck>(step_rule()), 1), "The course of the run in time t.")
      .optional("stabilization", &Deck::stabilization, stabilization_rule(),
                "Artificial resistance, to get past limit points (snap-through, buckling). Its work is reported and "
                "bounded by the certificate's `artificial`. When absent: none, at no cost.")
      .optional("estimate_path_error", &Deck::estimate_path_error, boolean(),
                "true: every increment is solved in two halves, too, for the estimate of the path error alone; takes "
                "about three times as long. Steps with a path_tolerance have the estimate anyway.")
      .optional("look_for_other_solutions", &Deck::look_for_other_solutions, boolean(),
                "true: every increment is solved from other starts, too (all contact open; without friction), and log "
                "and summary say when that leads to other contact tractions. Takes about three times as long. Not for "
                "`vi` and `basis: dual`.",
                "A. Klarbring, Ing.-Arch. 60 (1990) 529-541.")
      .optional(
          "figures", &Deck::figures, map_of("name of the figure", Rule<FigureDeck>(figure_rule())),
          "Mean displacements at the end whose errors the summary shall estimate (`errors.figures`), besides those "
          "of the pairs' forces and peak pressures. For linear elastic solids without friction.",
          "R. Becker, R. Rannacher, Acta Numerica 10 (2001) 1-102.")
      .optional("adapt", &Deck::adapt, adapt_rule(),
                "Mesh anew from the estimated error and run the whole history again, until a quantity of the end is "
                "accurate enough. The .geo is meshed freely, in triangles or tetrahedra, also where it has transfinite "
                "or recombined parts; mesh.parameters give the first mesh, which may be coarse.",
                "O. C. Zienkiewicz, J. Z. Zhu, Int. J. Numer. Methods Engrg. 33 (1992) 1331-1382.")
      .optional("certificate", &Deck::certificate, certificate_rule(),
                "Tolerances of the checks that every accepted increment must pass.")
      .optional("output", &Deck::output, output_rule(), "What is written, and where.")
      .optional("petsc", &Deck::petsc, map_of("PETSc option without its dash", raw_text("value; empty for a flag")),
                "PETSc options; those of the command line win.")
      .not_yet("inertia", "Leave the key out: this release solves quasi-static problems.");
  return rule;
}

const Rule<Deck>& the_rule() {
  static const Rule<Deck> rule = deck_rule();
  return rule;
}

std::string file_text(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw UserError("'" + path + "' is a folder, not a deck. Give the .yaml file.");
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    const bool exists = std::filesystem::exists(path, ignored);
    throw UserError("the deck '" + path + "' cannot be read: " + (exists ? "no permission" : "there is no such file") +
                    "." + (exists ? " Change its permissions." : nearest_file(path, {".yaml", ".yml"})));
  }
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

} // namespace

bool measures_path(const Deck& deck) {
  return deck.estimate_path_error || std::any_of(deck.steps.begin(), deck.steps.end(), [](const StepDeck& step) {
           const auto* automatic = std::get_if<AutoIncrements>(&step.increments);
           return automatic && automatic->path_tolerance;
         });
}

bool is_condensed(const EnforceDeck& enforce) {
  const auto* semismooth = std::get_if<SemismoothDeck>(&enforce);
  return semismooth && semismooth->basis == MultiplierBasis::Dual;
}

const std::string& enforce_advice() {
  static const std::string advice =
      "Take semismooth unless the problem is too large to factorize: it converges quadratically and knows friction, "
      "but "
      "with its default basis is a saddle point and needs a direct solver. A large problem takes semismooth with "
      "basis: "
      "dual (no more unknowns than displacements; symmetric positive definite without friction, so for multigrid), vi "
      "(the same without friction, with a search for a fall of energy) or uzawa; penalty is for quick looks.";
  return advice;
}

const Shape& deck_shape() { return *the_rule().shape; }

Deck parse_deck(const std::string& text, const std::string& path, bool look_for_mesh) {
  const auto root = parse_yaml(text, path);
  Deck deck;
  deck.path = path;
  const std::filesystem::path file(path);
  deck.folder = file.has_parent_path() ? file.parent_path().string() : ".";
  Reading reading;
  the_rule().read(root, deck, reading);
  check_deck(deck, root, reading);
  if (look_for_mesh) check_mesh_file_exists(deck, root, reading);
  reading.finish();
  if (deck.output.directory.empty()) deck.output.directory = "results/" + file.stem().string();
  return deck;
}

Deck read_deck(const std::string& path) { return parse_deck(file_text(path), path, true); }

Deck read_deck(MPI_Comm comm, const std::string& path) {
  std::string text;
  on_root(comm, [&] { text = file_text(path); });
  auto size = static_cast<unsigned long>(text.size());
  MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG, 0, comm);
  text.resize(size);
  MPI_Bcast(text.data(), static_cast<int>(size), MPI_CHAR, 0, comm);
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  Deck deck;
  together(comm, [&] { deck = parse_deck(text, path, rank == 0); });
  return deck;
}

} // namespace amontons
