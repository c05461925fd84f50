#include "deck_checks.hpp"

#include "base/error.hpp"
#include "deck/shape.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>

namespace amontons {

namespace {

const std::array<std::string, 3> axes = {"x", "y", "z"};

/// The deck under check, with what the checks need to say where.
struct Check {
  const Deck& deck;
  const DeckNode& root;
  Reading& reading;

  /// Is this part of the deck free of faults (or absent)?
  bool sound(const std::string& key) const {
    const auto* node = root.find(key);
    return !node || !reading.has_fault(*node);
  }
  bool space_is_known() const { return root.find("space") && sound("space"); }
  void fail(std::initializer_list<DeckStep> steps, const std::string& message) const {
    reading.fail(place_of(root, steps), message);
  }
};

std::string list_path(const std::string& key, std::size_t i) { return key + "[" + std::to_string(i) + "]"; }

std::string space_name(const Deck& deck) {
  switch (deck.space) {
  case Space::PlaneStrain:
    return "plane_strain";
  case Space::PlaneStress:
    return "plane_stress";
  case Space::Axisymmetric:
    return "axisymmetric";
  case Space::Solid:
    return "solid";
  }
  return "";
}

bool is_empty(const VectorDeck& vector) {
  return std::none_of(vector.begin(), vector.end(), [](const auto& component) { return component.has_value(); });
}

void check_mesh(const Check& check) {
  const auto& mesh = check.deck.mesh;
  if (!check.sound("mesh") || mesh.file.value.empty()) return;
  const auto ending = std::filesystem::path(mesh.file.value).extension().string();
  if (ending != ".geo" && ending != ".msh")
    check.fail({"mesh", "file"}, "mesh.file: '" + mesh.file.value +
                                     "' is neither a .geo nor a .msh file. Convert the " +
                                     "mesh with gmsh, for example `gmsh -save -format msh22 -o out.msh ...`.");
  if (ending == ".msh" && !mesh.parameters.empty())
    check.fail({"mesh", "parameters"}, "mesh.parameters: a .msh file is read as it is and has no parameters. Remove " +
                                           std::string("them, or name the .geo file that the mesh was made from."));
}

void check_bodies(const Check& check) {
  const auto& [deck, root, reading] = check;
  std::vector<std::string> names;
  for (const auto& [name, material] : deck.materials)
    names.push_back(name);
  for (const auto& [body, material] : deck.bodies) {
    if (names.empty() || material.value.empty() || deck.materials.contains(material.value)) continue;
    const auto match = nearest_match(material.value, names);
    reading.fail(material.place, "bodies." + body + ": there is no material '" + material.value + "'." +
                                     (match.empty() ? "" : " Did you mean '" + match + "'?") +
                                     " Materials of this deck: " + join_names(names) + ".");
  }
  std::vector<std::string> bodies;
  for (const auto& [body, material] : deck.bodies)
    bodies.push_back(body);
  for (const auto& [body, force] : deck.body_force) {
    if (is_empty(force.value) && check.sound("body_force"))
      check.fail({"body_force", body}, "body_force." + body + " has no component. Give x, y or z, or remove it.");
    if (bodies.empty() || deck.bodies.contains(body)) continue;
    const auto match = nearest_match(body, bodies);
    check.fail({"body_force", body}, "body_force: '" + body + "' is not one of the deck's bodies." +
                                         (match.empty() ? "" : " Did you mean '" + match + "'?") +
                                         " Bodies: " + join_names(bodies) + ".");
  }
}

/// Materials that the kinematics or the space cannot have.
void check_materials(const Check& check) {
  const auto& [deck, root, reading] = check;
  if (!check.sound("materials") || !check.sound("kinematics") || !check.space_is_known()) return;
  if (deck.kinematics == Kinematics::Finite && deck.space == Space::PlaneStress)
    check.fail({"kinematics"}, "kinematics: finite has no plane stress, for no law lets the thickness give way at "
                               "large strain. Set space: plane_strain, or model the sheet in space: solid.");
  for (const auto& [name, material] : deck.materials) {
    const auto path = "materials." + name;
    if (deck.space == Space::PlaneStress && std::holds_alternative<ElasticPlastic>(material.value.law))
      reading.fail(material.place, path + ": elastic_plastic has no plane stress, for its flow rule does not let the "
                                          "thickness give way. Set space: plane_strain, or model the sheet in space: "
                                          "solid.");
    if (deck.kinematics == Kinematics::Finite) continue;
    try {
      small_law(material.value.law, path);
    } catch (const UserError& error) {
      reading.fail(material.place, error.what());
    }
  }
}

/// Contact that finite kinematics cannot have.
void check_finite(const Check& check) {
  const auto& [deck, root, reading] = check;
  if (deck.kinematics != Kinematics::Finite || !check.sound("contact")) return;
  for (std::size_t i = 0; i < deck.contact.size(); ++i) {
    const auto path = list_path("contact", i);
    if (std::holds_alternative<SegmentIntegrationDeck>(deck.contact[i].integration))
      check.fail({"contact", i, "integration"},
                 path + ".integration: segments are cut once, in the reference configuration, and would no longer fit "
                        "the surfaces once they have slid. With kinematics: finite use `{facet: {order: 6}}`, or a "
                        "higher order.");
    if (std::holds_alternative<ViDeck>(deck.contact[i].enforce))
      check.fail({"contact", i, "enforce"},
                 path + ".enforce: vi bounds motions along normals of the reference configuration. With kinematics: "
                        "finite use `{semismooth: {}}`.");
    if (is_condensed(deck.contact[i].enforce))
      check.fail({"contact", i, "enforce"},
                 path +
                     ".enforce: the dual basis is made once, in the reference configuration. With kinematics: finite "
                     "use `{semismooth: {}}`.");
  }
}

/// What a smoothed master goes with.
void check_smoothing(const Check& check) {
  const auto& [deck, root, reading] = check;
  if (!check.sound("contact")) return;
  for (std::size_t i = 0; i < deck.contact.size(); ++i) {
    const auto& contact = deck.contact[i];
    if (!std::holds_alternative<CubicMasterDeck>(contact.smoothing)) continue;
    const auto refuse = [&](bool is_wrong, const std::string& why) {
      if (is_wrong) check.fail({"contact", i, "smoothing"}, list_path("contact", i) + ".smoothing: " + why);
    };
    refuse(meets_itself(contact), "a surface that meets itself is not smoothed, for only its master side would be. "
                                  "Take the smoothing out.");
    refuse(!meets_itself(contact) && !std::holds_alternative<Located<std::string>>(contact.master.value),
           "a rigid shape is smooth already. Take the smoothing out.");
    refuse(std::holds_alternative<SegmentIntegrationDeck>(contact.integration),
           "segments are cut by the facets of the mesh. Use `integration: {facet: {order: 6}}`.");
    refuse(std::holds_alternative<ViDeck>(contact.enforce) || is_condensed(contact.enforce),
           "vi and the dual basis have the facets of the mesh. Use `enforce: {semismooth: {}}`.");
  }
}

/// Components that the space does not have.
void check_space_of_vectors(const Check& check) {
  const auto& [deck, root, reading] = check;
  if (!check.space_is_known() || deck.dim() == 3) return;
  const auto message = [&deck = deck](const std::string& path) {
    return path + ": there is no z with space: " + space_name(deck) + ". Remove it, or set space: solid.";
  };
  for (std::size_t i = 0; i < deck.boundary.size(); ++i) {
    const auto& entry = deck.boundary[i];
    const std::pair<std::string, const VectorDeck*> vectors[] = {
        {"displacement", &entry.displacement}, {"traction", &entry.traction}, {"resultant", &entry.resultant}};
    for (const auto& [key, vector] : vectors)
      if ((*vector)[2]) check.fail({"boundary", i, key, "z"}, message(list_path("boundary", i) + "." + key + ".z"));
    if (deck.space == Space::Axisymmetric && entry.resultant[0])
      check.fail({"boundary", i, "resultant", "x"},
                 list_path("boundary", i) + ".resultant.x: radial forces have no resultant when axisymmetric. Use " +
                     "`traction: {x: ...}` or `pressure`.");
  }
  for (const auto& [body, force] : deck.body_force)
    if (force.value[2]) check.fail({"body_force", body, "z"}, message("body_force." + body + ".z"));
}

/// A component of a group may be prescribed once, and either as a displacement or as a resultant.
void check_boundary(const Check& check) {
  const auto& [deck, root, reading] = check;
  if (!check.sound("boundary")) return;
  struct First {
    std::size_t entry;
    std::string key;
  };
  std::map<std::pair<std::string, std::size_t>, First> taken;
  for (std::size_t i = 0; i < deck.boundary.size(); ++i) {
    const auto& entry = deck.boundary[i];
    const auto path = list_path("boundary", i);
    if (is_empty(entry.displacement) && is_empty(entry.traction) && is_empty(entry.resultant) && !entry.pressure)
      check.fail({"boundary", i}, path + " prescribes nothing on '" + entry.on.value + "'. Give a component of " +
                                      "displacement, traction or resultant, or a pressure, or remove the entry.");
    const std::pair<std::string, const VectorDeck*> vectors[] = {{"displacement", &entry.displacement},
                                                                 {"resultant", &entry.resultant}};
    for (const auto& [key, vector] : vectors)
      for (std::size_t c = 0; c < 3; ++c) {
        if (!(*vector)[c]) continue;
        const auto [at, fresh] = taken.try_emplace({entry.on.value, c}, First{i, key});
        if (fresh) continue;
        const auto& first = at->second;
        check.fail({"boundary", i, key, axes[c]}, path + "." + key + "." + axes[c] + ": '" + entry.on.value +
                                                      "' already has a " + first.key + " in " + axes[c] + " from " +
                                                      list_path("boundary", first.entry) + ". Keep one of the two.");
      }
  }
}

bool is_zero(const std::vector<double>& vector) {
  return std::all_of(vector.begin(), vector.end(), [](double component) { return component == 0.0; });
}

/// Have the two vectors one direction, or opposite ones? Zero has none of its own and is parallel to nothing.
bool are_parallel(const std::vector<double>& one, const std::vector<double>& other) {
  const auto dot = [](const auto& a, const auto& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); };
  if (one.size() != other.size() || is_zero(one) || is_zero(other)) return false;
  const double cosine_squared = dot(one, other) * dot(one, other) / (dot(one, one) * dot(other, other));
  return 1.0 - cosine_squared < 1e-12;
}

/// Vectors of one length.
bool are_orthogonal(const std::vector<double>& one, const std::vector<double>& other) {
  const auto dot = [](const auto& a, const auto& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); };
  return std::pow(dot(one, other), 2) <= 1e-20 * dot(one, one) * dot(other, other);
}

/// Checks of one rigid shape, written under `tag` of contact[i].master.
struct ShapeCheck {
  const Check& check;
  std::size_t i;
  std::string tag;

  void fail(const std::string& key, const std::string& message) const {
    check.fail({"contact", i, "master", tag, key}, list_path("contact", i) + ".master." + tag + "." + key + message);
  }
  void length(const std::string& key, const std::vector<double>& vector) const {
    if (!check.space_is_known() || vector.size() == std::size_t(check.deck.dim())) return;
    fail(key, " must have " + std::to_string(check.deck.dim()) + " components with space: " + space_name(check.deck) +
                  ", but has " + std::to_string(vector.size()) + ".");
  }
  void direction(const std::string& key, const std::vector<double>& vector) const {
    length(key, vector);
    if (is_zero(vector)) fail(key, " is zero and has no direction. Give a vector that is not zero.");
  }
  void displacement(const VectorDeck& vector) const {
    if (!check.space_is_known()) return;
    if (check.deck.dim() == 2 && vector[2])
      fail("displacement", ": there is no z with space: " + space_name(check.deck) + ". Remove it.");
    if (check.deck.space == Space::Axisymmetric && vector[0])
      fail("displacement", ": a rigid shape cannot move along the radius when axisymmetric. Remove x.");
  }

  void operator()(const Located<std::string>&) const {}
  void operator()(const PlaneDeck& plane) const {
    length("point", plane.point);
    direction("normal", plane.normal);
    displacement(plane.displacement);
  }
  void operator()(const SphereDeck& sphere) const {
    length("centre", sphere.centre);
    displacement(sphere.displacement);
    if (check.space_is_known() && check.deck.space == Space::Axisymmetric && sphere.centre[0] != 0.0)
      fail("centre", " must be on the axis, x = 0, when axisymmetric.");
  }
  void operator()(const CylinderDeck& cylinder) const {
    length("centre", cylinder.centre);
    displacement(cylinder.displacement);
    if (!check.space_is_known()) return;
    if (check.deck.dim() == 3 && cylinder.axis.empty())
      fail("axis", " is missing; with space: solid a cylinder needs it. Add its direction, for example [0, 0, 1].");
    if (check.deck.dim() == 3 && !cylinder.axis.empty()) direction("axis", cylinder.axis);
    if (check.deck.dim() == 2 && !cylinder.axis.empty())
      fail("axis", ": in 2D a cylinder is a disc whose axis points out of the plane. Remove the key.");
    if (check.deck.space == Space::Axisymmetric)
      fail("centre", ": there is no rigid cylinder with space: axisymmetric. Use a sphere or a plane.");
  }
  void operator()(const CornerDeck& corner) const {
    length("point", corner.point);
    displacement(corner.displacement);
    for (const auto& normal : corner.normals)
      direction("normals", normal);
    if (are_parallel(corner.normals[0], corner.normals[1]))
      fail("normals", " are parallel, so the faces do not meet in an edge. Give two directions, or use a plane.");
  }
  void operator()(const RoundedBoxDeck& box) const {
    if (check.space_is_known() && check.deck.dim() != 3)
      return fail("part", ": a rounded box needs space: solid. Use a corner, whose section it is.");
    length("point", box.point);
    direction("normal", box.normal);
    direction("side", box.side);
    displacement(box.displacement);
    if (box.normal.size() == box.side.size() && !are_orthogonal(box.normal, box.side))
      fail("side", " is not orthogonal to normal. Give a direction in the flat face.");
    if (box.corner_radius > std::min(box.half_widths[0], box.half_widths[1]))
      fail("corner_radius", " is larger than a half width. Give at most the smaller one.");
    if (box.part == BoxPart::Punch && box.edge_radius > box.corner_radius)
      fail("edge_radius", " of a punch is larger than its corner radius, so that the edge would have a crease. Give at "
                          "most the corner radius.");
  }
};

const std::string shape_tags[] = {"",         "plane",  "sphere",
                                  "cylinder", "corner", "rounded_box"}; // in the order of MasterDeck

bool is_bound(const EnforceDeck& enforce) { return std::holds_alternative<ViDeck>(enforce); }

/// `is_kind` replaces unknowns of the whole problem: all pairs are of that kind or none.
void check_all_or_none(const Check& check, bool (*is_kind)(const EnforceDeck&), const std::string& kind,
                       const std::string& key) {
  const auto& contacts = check.deck.contact;
  const auto of_kind = [is_kind](const ContactDeck& contact) { return is_kind(contact.enforce); };
  const auto one = std::find_if(contacts.begin(), contacts.end(), of_kind);
  const auto other = std::find_if_not(contacts.begin(), contacts.end(), of_kind);
  if (one == contacts.end() || other == contacts.end()) return;
  const auto i = static_cast<std::size_t>(other - contacts.begin());
  check.fail({"contact", i}, list_path("contact", i) + ": the pair '" + one->name.value + "' is enforced by " + kind +
                                 ", which serves all pairs of a deck or none. Give this pair `enforce: {" + key +
                                 "}` too, or that one `enforce: {semismooth: {}}`.");
}

/// A bound knows no friction.
void check_bounds(const Check& check) {
  const auto& contacts = check.deck.contact;
  check_all_or_none(check, is_bound, "vi", "vi: {}");
  if (std::none_of(contacts.begin(), contacts.end(), [](const auto& contact) { return is_bound(contact.enforce); }))
    check_all_or_none(check, is_condensed, "semismooth with the dual basis", "semismooth: {basis: dual}");
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (is_bound(contacts[i].enforce) && contacts[i].friction)
      check.fail({"contact", i, "friction"}, list_path("contact", i) + ".friction: vi is frictionless. Use " +
                                                 "`enforce: {semismooth: {}}`, or leave friction out.");
}

void check_contact(const Check& check) {
  const auto& [deck, root, reading] = check;
  if (!check.sound("contact")) return;
  check_bounds(check);
  std::map<std::string, std::size_t> names;
  std::map<std::set<std::string>, std::size_t> pairs;
  for (std::size_t i = 0; i < deck.contact.size(); ++i) {
    const auto& contact = deck.contact[i];
    const auto path = list_path("contact", i);
    const auto [same, fresh] = names.try_emplace(contact.name.value, i);
    if (!fresh)
      reading.fail(contact.name.place, path + ".name: '" + contact.name.value + "' is also the name of " +
                                           list_path("contact", same->second) + ". Give each pair its own name.");
    std::visit(ShapeCheck{check, i, shape_tags[contact.master.value.index()]}, contact.master.value);
    const auto* master = std::get_if<Located<std::string>>(&contact.master.value);
    if (!master) continue;
    if (contact.sides == ContactSides::Itself && deck.kinematics == Kinematics::Small)
      reading.fail(contact.slave.place, path + ".self: a surface comes to meet itself by large rotations, which "
                                               "kinematics: small leaves out. Set kinematics: finite.");
    if (!meets_itself(contact) && master->value == contact.slave.value) {
      reading.fail(contact.master.place, path + ": slave and master are the same surface '" + master->value +
                                             "'. Write `self: " + master->value + "` instead of both.");
      continue;
    }
    const auto [pair, new_pair] = pairs.try_emplace({contact.slave.value, master->value}, i);
    if (!new_pair)
      check.fail({"contact", i}, path + ": the surfaces '" + contact.slave.value + "' and '" + master->value +
                                     "' are a pair already in " + list_path("contact", pair->second) +
                                     ". Declare each pair once.");
  }
}

void check_steps(const Check& check) {
  const auto& steps = check.deck.steps;
  if (!check.sound("steps")) return;
  std::map<std::string, std::size_t> names;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto [same, fresh] = names.try_emplace(steps[i].name.value, i);
    if (!fresh)
      check.reading.fail(steps[i].name.place, list_path("steps", i) + ".name: '" + steps[i].name.value +
                                                  "' is also the name of " + list_path("steps", same->second) +
                                                  ". Give each step its own name.");
    if (i > 0 && steps[i].to <= steps[i - 1].to)
      check.fail({"steps", i, "to"}, list_path("steps", i) + ".to must be later than the end of the step before, " +
                                         number_text(steps[i - 1].to) + ", but is " + number_text(steps[i].to) + ".");
  }
}

void check_other_solutions(const Check& check) {
  if (!check.deck.look_for_other_solutions || !check.sound("contact")) return;
  for (std::size_t i = 0; i < check.deck.contact.size(); ++i) {
    const auto& enforce = check.deck.contact[i].enforce;
    if (is_condensed(enforce) || std::holds_alternative<ViDeck>(enforce))
      check.fail({"contact", i, "enforce"}, list_path("contact", i) +
                                                ".enforce: look_for_other_solutions holds contact points open, which "
                                                "`vi` and `basis: dual` cannot. Use `{semismooth: {}}`, uzawa or "
                                                "penalty, or remove look_for_other_solutions.");
  }
}

void check_output(const Check& check) {
  std::set<std::string> seen;
  for (const auto& field : check.deck.output.fields)
    if (!field.value.empty() && !seen.insert(field.value).second)
      check.reading.fail(field.place, "output.fields: '" + field.value + "' is listed twice. Keep one.");
}

void check_petsc(const Check& check) {
  for (const auto& [option, value] : check.deck.petsc)
    if (option.empty() || option[0] == '-' || option.find(' ') != std::string::npos)
      check.fail({"petsc", option}, "petsc: '" + option + "' is not the name of an option. Write it as one word " +
                                        "without its dash, for example `snes_rtol: 1e-9`.");
}

void check_figures(const Check& check) {
  for (const auto& [name, figure] : check.deck.figures)
    if (check.sound("space") && figure.component >= check.deck.dim())
      check.fail({"figures", name, "component"}, "figures." + name + ".component: there is no z with space: " +
                                                     space_name(check.deck) + ". Take x or y.");
}

void check_adapt(const Check& check) {
  const auto& [deck, root, reading] = check;
  if (!deck.adapt || !check.sound("adapt")) return;
  if (check.sound("mesh") && std::filesystem::path(deck.mesh.file.value).extension() == ".msh")
    check.fail({"adapt"}, "adapt: a .msh file has no geometry to mesh anew. Name the .geo file that it was made from, "
                          "or remove adapt.");
  if (deck.mesh.refine > 0)
    check.fail({"mesh", "refine"}, "mesh.refine: adapt chooses the sizes of cells itself. Remove one of the two.");
  const auto quantity = deck.adapt->quantity;
  const bool of_pair = quantity == AdaptQuantity::PeakPressure || quantity == AdaptQuantity::Force;
  std::vector<std::string> names;
  for (const auto& contact : deck.contact)
    names.push_back(contact.name.value);
  const auto& pair = deck.adapt->pair;
  if (pair && !of_pair)
    check.fail({"adapt", "pair"}, "adapt.pair: the quantity is one of the whole scene. Remove pair.");
  else if (pair && std::find(names.begin(), names.end(), *pair) == names.end())
    check.fail({"adapt", "pair"}, "adapt.pair: there is no contact pair '" + *pair + "'. " +
                                      (names.empty() ? "The deck has none." : "Pairs: " + join_names(names) + "."));
  else if (of_pair && !pair && names.size() != 1 && check.sound("contact"))
    check.fail({"adapt"}, names.empty()
                              ? "adapt.quantity: the deck has no contact pair. Use `quantity: energy` or "
                                "`energy_norm`."
                              : "adapt: the deck has " + std::to_string(names.size()) +
                                    " contact pairs. Say which one counts with `pair`: " + join_names(names) + ".");
}

} // namespace

std::string nearest_file(const std::string& path, const std::vector<std::string>& endings) {
  const std::filesystem::path wanted(path);
  const auto folder = wanted.has_parent_path() ? wanted.parent_path() : std::filesystem::path(".");
  std::error_code failed;
  std::filesystem::directory_iterator files(folder, failed);
  if (failed) return " There is no folder '" + folder.string() + "' either: check the path.";
  std::vector<std::string> names;
  for (const auto& file : files)
    if (std::find(endings.begin(), endings.end(), file.path().extension().string()) != endings.end())
      names.push_back(file.path().filename().string());
  std::sort(names.begin(), names.end());
  const auto match = nearest_match(wanted.filename().string(), names);
  if (!match.empty()) return " Did you mean '" + match + "'?";
  if (names.empty() || names.size() > 12) return " Check the path.";
  return " Files of that kind in its folder: " + join_names(names) + ".";
}

void check_deck(const Deck& deck, const DeckNode& root, Reading& reading) {
  const Check check{deck, root, reading};
  check_mesh(check);
  check_bodies(check);
  check_materials(check);
  check_finite(check);
  check_smoothing(check);
  check_space_of_vectors(check);
  check_boundary(check);
  check_contact(check);
  check_steps(check);
  check_other_solutions(check);
  check_figures(check);
  check_adapt(check);
  check_output(check);
  check_petsc(check);
}

void check_mesh_file_exists(const Deck& deck, const DeckNode& root, Reading& reading) {
  const auto* mesh = root.find("mesh");
  if (!mesh || reading.has_fault(*mesh) || deck.mesh.file.value.empty()) return;
  const auto path = (std::filesystem::path(deck.folder) / deck.mesh.file.value).string();
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) return;
  reading.fail(place_of(root, {"mesh", "file"}), "mesh.file: there is no file '" + path + "'." +
                                                     nearest_file(path, {".geo", ".msh"}) +
                                                     " The name counts from the deck's folder.");
}

} // namespace amontons
