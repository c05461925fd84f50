#include "mesh/gmsh_session.hpp"

#include "base/error.hpp"
#include "mesh/geo_script.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gmsh.h>
#include <sys/wait.h>
#include <unistd.h>

namespace amontons {
namespace {

namespace fs = std::filesystem;

std::string in_quotes(const std::string& text) { return "'" + text + "'"; }

/// What gmsh has logged as errors since the log was last emptied, each once.
std::vector<std::string> logged_errors() {
  std::vector<std::string> log, errors;
  gmsh::logger::get(log);
  const std::string mark = "Error: ";
  for (const auto& line : log)
    if (line.starts_with(mark) && std::find(errors.begin(), errors.end(), line.substr(mark.size())) == errors.end())
      errors.push_back(line.substr(mark.size()));
  return errors;
}

/// The names in the $PhysicalNames section, which is text and near the top in every version and encoding of the format.
DeclaredGroups physical_names(const std::string& msh_file) {
  DeclaredGroups groups;
  std::ifstream stream(msh_file);
  std::string line;
  while (std::getline(stream, line) && !line.starts_with("$PhysicalNames"))
    if (line.starts_with("$Nodes")) return groups;
  std::getline(stream, line);
  while (std::getline(stream, line) && !line.starts_with("$")) {
    const auto begin = line.find('"'), end = line.rfind('"');
    if (begin != std::string::npos && end > begin)
      groups.insert({std::atoi(line.c_str()), line.substr(begin + 1, end - begin - 1)});
  }
  return groups;
}

/// A file for gmsh to write or read, in the folder for temporary files; gone with the object.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& ending) {
    name_ = (fs::temp_directory_path() / ("amontons_XXXXXX" + ending)).string();
    const int descriptor = mkstemps(name_.data(), static_cast<int>(ending.size()));
    if (descriptor < 0)
      throw UserError("No temporary file can be made in " + in_quotes(fs::temp_directory_path().string()) +
                      "; make room there or set TMPDIR to a folder that can be written to.");
    close(descriptor);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(name_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};

/// gmsh's API does not tell of physical groups without entities, but the files that it writes do.
DeclaredGroups names_known_to_gmsh(GmshSession& session) {
  const TemporaryFile file(".msh");
  session.run("The physical names of the mesh cannot be written to " + in_quotes(file.name()),
              [&] { gmsh::write(file.name()); });
  return physical_names(file.name());
}

void check_parameters(const MeshSource& source) {
  const auto known = geo_parameters(source.file);
  std::vector<std::string> messages;
  for (const auto& [name, value] : source.parameters) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string message = "Mesh file " + in_quotes(source.file) + " has no parameter " + in_quotes(name);
    if (const auto near = nearest_match(name, known); !near.empty())
      message += "; did you mean " + in_quotes(near) + "?";
    message += known.empty() ? "; it has none: declare it there with DefineConstant[" + name + " = value];"
                             : " Those that it declares with DefineConstant: " + join_names(known) + ".";
    messages.push_back(message);
  }
  if (!messages.empty()) throw UserError(messages);
}

/// Throws unless the file is there, readable and looks like what its name says.
void check_file(const MeshSource& source) {
  const fs::path path(source.file);
  const std::string file = "Mesh file " + in_quotes(source.file);
  const auto extension = path.extension();
  if (extension != ".geo" && extension != ".msh")
    throw UserError(file +
                    " has a name that ends neither in .geo nor in .msh; give a gmsh script (.geo) or a gmsh mesh "
                    "(.msh, versions 2.2 and 4.1).");
  if (!fs::is_regular_file(path))
    throw UserError(file + " does not exist; check mesh: file (relative to the deck's folder).");
  std::ifstream stream(path);
  std::string line;
  if (!stream || !std::getline(stream, line)) {
    if (fs::file_size(path) == 0) throw UserError(file + " is empty; write the mesh again.");
    throw UserError(file + " cannot be read; check its permissions.");
  }
  if (extension == ".geo") return check_parameters(source);
  if (!line.starts_with("$"))
    throw UserError(file +
                    " is not a gmsh mesh: it does not begin with $MeshFormat; save it from gmsh as version 4.1.");
  if (!source.parameters.empty())
    throw UserError(file + " takes no parameters, only a .geo does; remove mesh: parameters.");
}

/// Where a file of version 2 does not say how many nodes or elements follow, gmsh 4.8 takes the number that happens to
/// be in memory: it may crash in one process and not in its child. So that is looked at here, by the function that gmsh
/// asks.
void check_counts(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line, count;
  for (std::int64_t number = 1; std::getline(stream, line); ++number) {
    const bool is_format = line.starts_with("$MeshFormat");
    if (!is_format && !line.starts_with("$Nodes") && !line.starts_with("$ParametricNodes") &&
        !line.starts_with("$Elements"))
      continue;
    std::getline(stream, count);
    ++number;
    if (is_format && !count.starts_with("2")) return;
    int value = 0;
    if (!is_format && std::sscanf(count.c_str(), "%d", &value) != 1)
      throw UserError("Mesh file " + in_quotes(file) + " is damaged: its line " + std::to_string(number) +
                      " must say how many entries the section " + line.substr(0, line.find_first_of("\r\n ")) +
                      " has. Save it from gmsh again, as version 4.1.");
  }
}

/// gmsh 4.8 crashes over some damaged meshes, and would take the program with it. So a child process reads a .msh
/// first; that costs the time of reading it once more. (A .geo has cells only once it is meshed.)
void check_that_gmsh_survives(const std::string& file) {
  const pid_t child = fork();
  if (child == 0) {
    for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
      std::signal(number, SIG_DFL); // PETSc's handlers end all ranks
    try {
      gmsh::open(file);
    } catch (...) { // what gmsh complains of, the reader in this process tells
    }
    _exit(0);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) return; // no process to be had: read without this net
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw UserError("Mesh file " + in_quotes(file) +
                    " is damaged: gmsh crashes when it reads it. Save it from gmsh again, as version 4.1.");
}

/// Orders of the elements (not points) of the model, ascending.
std::set<int> element_orders() {
  std::set<int> orders;
  std::vector<int> types;
  gmsh::model::mesh::getElementTypes(types);
  for (const int type : types) {
    std::string name;
    int dim = 0, order = 0, nodes = 0, corners = 0;
    std::vector<double> local;
    gmsh::model::mesh::getElementProperties(type, name, dim, order, nodes, local, corners);
    if (dim > 0) orders.insert(order);
  }
  return orders;
}

void generate_mesh(GmshSession& session, const MeshSource& source) {
  const std::string failure = "Mesh file " + in_quotes(source.file) + " cannot be meshed";
  const int dim = gmsh::model::getDimension();
  if (dim < 2)
    throw UserError("Mesh file " + in_quotes(source.file) +
                    " makes no surface or volume to mesh; define a Surface or Volume in it.");
  std::vector<int> types;
  gmsh::model::mesh::getElementTypes(types, dim);
  if (types.empty()) session.run(failure, [&] { gmsh::model::mesh::generate(dim); });
}

/// The model as a plain list of points, curves, surfaces ... without the lines that make parts of it structured.
struct PlainScript {
  std::string text;
  bool was_structured = false;
  bool has_size_field = false; // without one, the sizes of structured parts are lost with their structure
};

PlainScript plain_script(GmshSession& session, const MeshSource& source) {
  const TemporaryFile file(".geo_unrolled");
  session.run("Mesh file " + in_quotes(source.file) + " cannot be written out", [&] { gmsh::write(file.name()); });
  PlainScript script;
  std::ifstream stream(file.name());
  for (std::string line; std::getline(stream, line);) {
    const bool structured = line.starts_with("Transfinite") || line.starts_with("Recombine");
    script.was_structured = script.was_structured || structured;
    script.has_size_field = script.has_size_field || line.starts_with("Background Field");
    if (!structured) script.text += line + "\n";
  }
  return script;
}

/// The sizes of the cells that the script has made.
std::vector<SizeSample> sizes_of_cells(int dim) {
  std::vector<SizeSample> samples;
  std::vector<int> types;
  gmsh::model::mesh::getElementTypes(types, dim);
  for (const int type : types) {
    std::vector<double> local, weights, jacobians, determinants, places;
    gmsh::model::mesh::getIntegrationPoints(type, "Gauss1", local, weights);
    gmsh::model::mesh::getJacobians(type, local, jacobians, determinants, places);
    for (std::size_t q = 0; q < determinants.size(); ++q) {
      const double edge = equilateral_edge(dim, std::abs(determinants[q]) * weights[q % weights.size()]);
      samples.push_back(
          {.place = {places[3 * q], places[3 * q + 1], places[3 * q + 2]}, .radius = 0.5 * edge, .size = edge});
    }
  }
  return samples;
}

/// From now on gmsh makes cells of these sizes, whatever the script says.
void impose_sizes(const std::shared_ptr<const SizeField>& sizes) {
  for (const char* option :
       {"Mesh.MeshSizeExtendFromBoundary", "Mesh.MeshSizeFromPoints", "Mesh.MeshSizeFromCurvature", "Mesh.MeshSizeMin"})
    gmsh::option::setNumber(option, 0);
  gmsh::option::setNumber("Mesh.MeshSizeMax", 1e22);
  gmsh::option::setNumber("Mesh.MeshSizeFactor", 1);
  // The least of callback and background field counts, so the script's field gives way to one that asks for nothing.
  const int nothing = gmsh::model::mesh::field::add("MathEval");
  gmsh::model::mesh::field::setString(nothing, "F", "1e22");
  gmsh::model::mesh::field::setAsBackgroundMesh(nothing);
  gmsh::model::mesh::setSizeCallback([sizes](int, int, double x, double y, double z) { return (*sizes)({x, y, z}); });
}

void free_from_script(GmshSession& session, const MeshSource& source) {
  const std::string failure = "Mesh file " + in_quotes(source.file) + " cannot be meshed freely";
  gmsh::model::mesh::removeConstraints(); // gmsh's own kernel brings its own constraints back: hence the rest
  const auto script = plain_script(session, source);
  auto sizes = source.free->sizes;
  if (script.was_structured) {
    if (!sizes && !script.has_size_field) {
      generate_mesh(session, source);
      sizes = std::make_shared<const SizeField>(sizes_of_cells(gmsh::model::getDimension()), usual_growth);
    }
    const TemporaryFile file(".geo");
    std::ofstream(file.name()) << script.text;
    session.run(failure, [&] { gmsh::open(file.name()); });
  }
  gmsh::model::mesh::clear();
  for (const char* option : {"Mesh.RecombineAll", "Mesh.Recombine3DAll", "Mesh.SubdivisionAlgorithm"})
    gmsh::option::setNumber(option, 0);
  gmsh::option::setNumber("Mesh.ElementOrder", 1);
  if (sizes) impose_sizes(sizes);
}

void bring_to_order(GmshSession& session, const MeshSource& source, std::optional<int> order) {
  const auto orders = element_orders();
  if (!order || orders.empty() || orders == std::set<int>{*order}) return;
  session.run("Mesh file " + in_quotes(source.file) + " cannot be brought to order " + std::to_string(*order),
              [&] { gmsh::model::mesh::setOrder(*order); });
}

/// Whether the Jacobian of a cell has both signs, or vanishes, at its nodes.
bool has_twisted_cells(int dim) {
  std::vector<int> types;
  gmsh::model::mesh::getElementTypes(types, dim);
  for (const int type : types) {
    std::string name;
    int cell_dim = 0, order = 0, nodes = 0, corners = 0;
    std::vector<double> local, places, jacobians, determinants, unused;
    gmsh::model::mesh::getElementProperties(type, name, cell_dim, order, nodes, local, corners);
    for (int node = 0; node < nodes; ++node) // gmsh wants three coordinates of each
      for (int c = 0; c < 3; ++c)
        places.push_back(c < dim ? local[std::size_t(node) * dim + c] : 0.0);
    gmsh::model::mesh::getJacobians(type, places, jacobians, determinants, unused);
    for (std::size_t cell = 0; cell < determinants.size(); cell += nodes) {
      double smallest = 0.0, largest = 0.0;
      for (std::size_t at = cell; at < cell + nodes; ++at) {
        const double* j = &jacobians[9 * at]; // gmsh's determinant of a surface has no sign
        const double determinant = dim == 2 ? j[0] * j[4] - j[1] * j[3] : determinants[at];
        smallest = at == cell ? determinant : std::min(smallest, determinant);
        largest = at == cell ? determinant : std::max(largest, determinant);
      }
      if (smallest <= 0.0 && largest >= 0.0) return true;
    }
  }
  return false;
}

/// In cells of order 2 at a curved boundary only the nodes on it have moved there, and thin cells turn over. Lets the
/// nodes inside follow like those of an elastic body. What that does not mend is refused later with its place.
void relax_curved_cells(GmshSession& session, const MeshSource& source) {
  if (!has_twisted_cells(gmsh::model::getDimension())) return;
  session.run("The curved cells of mesh file " + in_quotes(source.file) + " cannot be mended",
              [] { gmsh::model::mesh::optimize("HighOrderElastic"); });
}

} // namespace

GmshSession::GmshSession(const std::map<std::string, double>& parameters) {
  std::vector<std::string> arguments = {"amontons"};
  for (const auto& [name, value] : parameters) {
    char number[32];
    std::snprintf(number, sizeof number, "%.17g", value);
    arguments.insert(arguments.end(), {"-setnumber", name, number});
  }
  std::vector<char*> pointers;
  for (auto& argument : arguments)
    pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  gmsh::initialize(static_cast<int>(arguments.size()), pointers.data(), false);
  gmsh::option::setNumber("General.Terminal", 0);
  // 1: stop meshing and only log; by default the API throws, also out of gmsh's OpenMP regions, which ends the program
  gmsh::option::setNumber("General.AbortOnError", 1);
  gmsh::option::setNumber("Mesh.PartitionConvertMsh2", 0); // partitions of a .msh are not used, and gmsh 4.8 crashes
                                                           // over some that make no sense
  gmsh::logger::start();
}

GmshSession::~GmshSession() {
  gmsh::logger::stop(); // the log would outlive the session
  gmsh::finalize();
}

void GmshSession::fail_on_errors(const std::string& doing, const std::string& thrown) {
  auto errors = logged_errors();
  if (errors.empty() && !thrown.empty()) errors.push_back(thrown);
  if (errors.empty()) return;
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(errors.size(), most); ++i)
    text += (i == 0 ? "" : "; ") + errors[i];
  if (errors.size() > most) text += "; and " + std::to_string(errors.size() - most) + " more";
  throw UserError(doing + ": gmsh reports: " + text + ". Open it in gmsh and mend it.");
}

DeclaredGroups load_model(GmshSession& session, const MeshSource& source) {
  check_file(source);
  const bool script = source.file.ends_with(".geo");
  if (!script) {
    check_counts(source.file);
    check_that_gmsh_survives(source.file);
  }
  session.run("Mesh file " + in_quotes(source.file) + " cannot be read", [&] { gmsh::open(source.file); });
  const auto groups = script ? names_known_to_gmsh(session) : physical_names(source.file);
  if (source.free) {
    if (!script)
      throw UserError("Mesh file " + in_quotes(source.file) +
                      " cannot be meshed anew: a .msh file has no geometry. Give the .geo file that it was made from.");
    free_from_script(session, source);
  }
  if (script) generate_mesh(session, source);
  const auto orders = element_orders();
  if (script || (!orders.empty() && *orders.rbegin() <= 2))
    bring_to_order(session, source, script ? source.order.value_or(1) : source.order);
  if (script && source.order == 2) relax_curved_cells(session, source);
  return groups;
}

} // namespace amontons
