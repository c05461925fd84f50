#include "output/checkpoint.hpp"

#include "base/error.hpp"
#include "mesh/topology.hpp"
#include "output/hdf5_file.hpp"
#include "output/key_match.hpp"
#include "output/text_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

namespace amontons {

namespace {

constexpr std::int64_t format_version = 4;
const std::string root = "/checkpoint";

/// FNV-1a: enough to tell two decks apart, and the same on every machine.
std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 0xCBF29CE484222325ull;
  for (const char c : text)
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
  return hash;
}

/// The sum of all nodes' keys, modulo 2^64: the same for every partition of a mesh. Collective.
std::uint64_t key_sum(const Mesh& mesh) {
  const std::uint64_t mine = std::accumulate(mesh.keys.begin(), mesh.keys.begin() + mesh.num_owned, std::uint64_t(0));
  std::uint64_t sum = 0;
  MPI_Allreduce(&mine, &sum, 1, MPI_UINT64_T, MPI_SUM, mesh.comm);
  return sum;
}

/// Arrays of the file are doubles, in which the halves of a key are exact.
std::vector<double> halves(std::span<const std::uint64_t> keys) {
  std::vector<double> values;
  values.reserve(2 * keys.size());
  for (const auto key : keys) {
    values.push_back(double(key >> 32));
    values.push_back(double(key & 0xFFFFFFFFull));
  }
  return values;
}

std::vector<std::uint64_t> joined(std::span<const double> values) {
  std::vector<std::uint64_t> keys(values.size() / 2);
  for (std::size_t i = 0; i < keys.size(); ++i)
    keys[i] = (std::uint64_t(values[2 * i]) << 32) | std::uint64_t(values[2 * i + 1]);
  return keys;
}

/// A name of a facet or cell that depends on nothing but the keys of its corners.
std::uint64_t element_key(const Mesh& mesh, ElementType type, std::span<const std::int32_t> nodes) {
  std::vector<std::int64_t> corners;
  for (int a = 0; a < num_vertices(type); ++a)
    corners.push_back(static_cast<std::int64_t>(mesh.keys[nodes[a]]));
  return corners.size() > 4 ? CornerSetHash{}(corner_set<8>(corners)) : CornerSetHash{}(corner_set<4>(corners));
}

/// What the two kinds of rows differ in: what they are called in the file, the group that they belong to, and the keys
/// of the group's elements on this rank (none for a group that the mesh lacks).
struct FacetRows {
  using Array = FacetArray;
  static constexpr const char* kind = "facet";
  static auto& arrays(auto& checkpoint) { return checkpoint.facets; }
  static auto& group(auto& array) { return array.surface; }
  static std::string description(const Array& array) { return "surface '" + array.surface + "'"; }
  static bool has_group(const Mesh& mesh, const Array& array) { return mesh.surfaces.contains(array.surface); }
  static std::vector<std::uint64_t> keys(const Mesh& mesh, const Array& array) {
    std::vector<std::uint64_t> names;
    if (!has_group(mesh, array)) return names;
    const FacetSet& facets = mesh.surfaces.at(array.surface);
    for (std::int32_t f = 0; f < facets.size(); ++f)
      names.push_back(element_key(mesh, facets.types[f], facets.facet(f)));
    return names;
  }
};

struct CellRows {
  using Array = CellArray;
  static constexpr const char* kind = "cell";
  static auto& arrays(auto& checkpoint) { return checkpoint.cells; }
  static auto& group(auto& array) { return array.body; }
  static std::string description(const Array& array) { return "body '" + array.body + "'"; }
  static bool has_group(const Mesh& mesh, const Array& array) {
    return std::find(mesh.bodies.begin(), mesh.bodies.end(), array.body) != mesh.bodies.end();
  }
  static std::vector<std::uint64_t> keys(const Mesh& mesh, const Array& array) {
    std::vector<std::uint64_t> names;
    for (const auto& block : mesh.blocks)
      for (std::int32_t c = 0; mesh.bodies[block.body] == array.body && c < block.size(); ++c)
        names.push_back(element_key(mesh, block.type, block.cell(c)));
    return names;
  }
};

std::int64_t sum_over_ranks(MPI_Comm comm, std::int64_t mine) {
  std::int64_t sum = 0;
  MPI_Allreduce(&mine, &sum, 1, MPI_INT64_T, MPI_SUM, comm);
  return sum;
}

std::string dataset(const char* kind, std::size_t i) { return root + "/" + kind + "_" + std::to_string(i); }
/// Attributes that belong to dataset i: "nodal_0_name", "nodal_0_components" ...
std::string attribute(const char* kind, std::size_t i, const char* what) {
  return std::string(kind) + "_" + std::to_string(i) + "_" + what;
}

/// Arrays of one kind: keys and numbers of rows, element by element, and the rows themselves.
template <class Kind>
void write_rows(Hdf5File& file, const Mesh& mesh, const Checkpoint& checkpoint) {
  const std::string kind = Kind::kind;
  file.write_attribute(root, kind + "_count", std::int64_t(Kind::arrays(checkpoint).size()));
  std::size_t i = 0;
  for (const auto& [name, array] : Kind::arrays(checkpoint)) {
    const auto keys = Kind::keys(mesh, array);
    file.write_attribute(root, attribute(Kind::kind, i, "name"), name);
    file.write_attribute(root, attribute(Kind::kind, i, "group"), Kind::group(array));
    file.write_attribute(root, attribute(Kind::kind, i, "components"), std::int64_t(array.components));
    file.write_attribute(root, attribute(Kind::kind, i, "elements"),
                         sum_over_ranks(mesh.comm, static_cast<std::int64_t>(keys.size())));
    file.write_attribute(root, attribute(Kind::kind, i, "rows"),
                         sum_over_ranks(mesh.comm, static_cast<std::int64_t>(array.values.size()) / array.components));
    file.write(dataset((kind + "_keys").c_str(), i), 2, halves(keys));
    file.write(dataset((kind + "_rows").c_str(), i), 1, std::vector<double>(array.rows.begin(), array.rows.end()));
    file.write(dataset(Kind::kind, i), array.components, array.values);
    ++i;
  }
}

void write_contents(Hdf5File& file, const Mesh& mesh, const std::string& identity, const Checkpoint& checkpoint) {
  file.write_attribute(root, "format", format_version);
  file.write_attribute(root, "nodes", std::to_string(mesh.num_global));
  file.write_attribute(root, "key_sum", std::to_string(key_sum(mesh)));
  file.write_attribute(root, "identity", std::to_string(hash_of(identity)));
  file.write_attribute(root, "time", checkpoint.time);
  file.write_attribute(root, "step", std::int64_t(checkpoint.step));
  file.write_attribute(root, "increment", std::int64_t(checkpoint.increment));
  file.write_attribute(root, "next_increment", checkpoint.next_increment);
  const auto owned = static_cast<std::size_t>(mesh.num_owned);
  file.write(root + "/keys", 2, halves(std::span(mesh.keys).first(owned)));

  file.write_attribute(root, "nodal_count", std::int64_t(checkpoint.nodal.size()));
  std::size_t i = 0;
  for (const auto& [name, array] : checkpoint.nodal) {
    file.write_attribute(root, attribute("nodal", i, "name"), name);
    file.write_attribute(root, attribute("nodal", i, "components"), std::int64_t(array.components));
    file.write(dataset("nodal", i), array.components, std::span(array.values).first(owned * array.components));
    ++i;
  }
  write_rows<FacetRows>(file, mesh, checkpoint);
  write_rows<CellRows>(file, mesh, checkpoint);

  int rank = 0;
  MPI_Comm_rank(mesh.comm, &rank);
  file.write_attribute(root, "global_count", std::int64_t(checkpoint.global.size()));
  i = 0;
  for (const auto& [name, values] : checkpoint.global) {
    file.write_attribute(root, attribute("global", i, "name"), name);
    file.write_attribute(root, attribute("global", i, "size"), std::int64_t(values.size()));
    file.write(dataset("global", i), 1, std::span(values).first(rank == 0 ? values.size() : 0));
    ++i;
  }
}

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw UserError("The checkpoint " + path + " cannot be used: " + reason + ".");
}

/// Attributes are the same on all ranks, and so is what is thrown.
void check_identity(Hdf5File& file, const Mesh& mesh, const std::string& path, const std::string& identity) {
  if (!file.has_group(root)) refuse(path, "it is not a checkpoint of this program");
  const auto format = file.read_integer(root, "format");
  if (format != format_version)
    refuse(path, "it has format " + std::to_string(format) + " and this version of the program reads format " +
                     std::to_string(format_version) + ". Restart with the version that wrote it");
  const std::string nodes = file.read_string(root, "nodes");
  const std::string same_mesh =
      ". Restart with the mesh, mesh parameters, order and refinement of the run that wrote it";
  if (nodes != std::to_string(mesh.num_global))
    refuse(path, "it was written on a mesh of " + nodes + " nodes and this one has " + std::to_string(mesh.num_global) +
                     same_mesh);
  if (file.read_string(root, "key_sum") != std::to_string(key_sum(mesh)))
    refuse(path, "it was written on another mesh with the same number of nodes" + same_mesh);
  if (file.read_string(root, "identity") != std::to_string(hash_of(identity)))
    refuse(path, "it was written for another deck. Restart with the deck of the run that wrote it; only what "
                 "does not describe the state (later steps, output, solver options) may change");
}

/// This rank's share of the rows of the file when it is cut evenly.
struct Share {
  std::int64_t first, size;
};

Share even_share(MPI_Comm comm, std::int64_t rows) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const std::int64_t first = rows * rank / ranks;
  return {first, rows * (rank + 1) / ranks - first};
}

/// Values at the local nodes from those in the file's order. Collective.
std::vector<double> picked(MPI_Comm comm, int components, std::vector<double> in_file, std::span<const PetscInt> rows) {
  const auto num_rows = static_cast<PetscInt>(rows.size());
  std::vector<double> values(rows.size() * components);
  VecHandle from, to;
  AMT_PETSC(VecCreateMPIWithArray(comm, components, static_cast<PetscInt>(in_file.size()), PETSC_DECIDE, in_file.data(),
                                  from.put()));
  AMT_PETSC(VecCreateSeqWithArray(PETSC_COMM_SELF, components, num_rows * components, values.data(), to.put()));
  IsHandle index;
  AMT_PETSC(ISCreateBlock(PETSC_COMM_SELF, components, num_rows, rows.data(), PETSC_USE_POINTER, index.put()));
  ScatterHandle scatter;
  AMT_PETSC(VecScatterCreate(from, index, to, nullptr, scatter.put()));
  AMT_PETSC(VecScatterBegin(scatter, from, to, INSERT_VALUES, SCATTER_FORWARD));
  AMT_PETSC(VecScatterEnd(scatter, from, to, INSERT_VALUES, SCATTER_FORWARD));
  return values;
}

/// Values per node or row of an array. Throws the same on all ranks.
int read_components(Hdf5File& file, const std::string& path, const std::string& attribute) {
  const auto components = file.read_integer(root, attribute);
  if (components < 1) refuse(path, "it is damaged: its attribute " + attribute + " is " + std::to_string(components));
  return static_cast<int>(components);
}

/// Throws unless the numbers of rows of all elements are whole and add up to those in the file. Collective.
void check_rows(MPI_Comm comm, const std::string& path, const std::vector<double>& rows_in_file, std::int64_t all) {
  double sum = 0.0;
  bool whole = true;
  for (const double rows : rows_in_file) {
    whole = whole && rows >= 0.0 && rows <= double(all) && rows == std::floor(rows);
    sum += rows;
  }
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, comm);
  together(comm, [&] {
    if (!whole || sum != double(all)) refuse(path, "it is damaged: its tables of rows are not those of its arrays");
  });
}

void read_nodal(Hdf5File& file, const Mesh& mesh, const std::string& path, Checkpoint& checkpoint) {
  const Share share = even_share(mesh.comm, mesh.num_global);
  const auto keys = joined(file.read(root + "/keys", 2 * share.size));
  const auto found = rows_of_keys(mesh.comm, keys, share.first, mesh.keys);
  together(mesh.comm, [&] {
    if (std::find(found.begin(), found.end(), -1) != found.end())
      refuse(path, "it was written on another mesh with the same number of nodes");
  });
  const std::vector<PetscInt> rows(found.begin(), found.end());
  const auto count = static_cast<std::size_t>(file.read_integer(root, "nodal_count"));
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = file.read_string(root, attribute("nodal", i, "name"));
    const int components = read_components(file, path, attribute("nodal", i, "components"));
    auto in_file = file.read(dataset("nodal", i), components * share.size);
    checkpoint.nodal[name] = {components, picked(mesh.comm, components, std::move(in_file), rows)};
  }
}

/// First row and number of rows in the file of each wanted element (rows of the tables of keys). Collective.
std::vector<double> row_ranges(MPI_Comm comm, const std::vector<double>& rows_in_file,
                               std::span<const PetscInt> wanted) {
  double mine = std::accumulate(rows_in_file.begin(), rows_in_file.end(), 0.0), first = 0.0;
  MPI_Exscan(&mine, &first, 1, MPI_DOUBLE, MPI_SUM, comm);
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank == 0) first = 0.0; // MPI leaves it undefined there
  std::vector<double> ranges;
  for (const double rows : rows_in_file) {
    ranges.insert(ranges.end(), {first, rows});
    first += rows;
  }
  return picked(comm, 2, std::move(ranges), wanted);
}

template <class Kind>
void read_rows(Hdf5File& file, const Mesh& mesh, const std::string& path, Checkpoint& checkpoint) {
  const std::string kind = Kind::kind;
  const auto count = static_cast<std::size_t>(file.read_integer(root, kind + "_count"));
  for (std::size_t i = 0; i < count; ++i) {
    typename Kind::Array array;
    Kind::group(array) = file.read_string(root, attribute(Kind::kind, i, "group"));
    array.components = read_components(file, path, attribute(Kind::kind, i, "components"));
    const Share share = even_share(mesh.comm, file.read_integer(root, attribute(Kind::kind, i, "elements")));
    const auto all_rows = file.read_integer(root, attribute(Kind::kind, i, "rows"));
    const Share rows = even_share(mesh.comm, all_rows);
    const auto keys = joined(file.read(dataset((kind + "_keys").c_str(), i), 2 * share.size));
    const auto rows_in_file = file.read(dataset((kind + "_rows").c_str(), i), share.size);
    check_rows(mesh.comm, path, rows_in_file, all_rows);
    auto in_file = file.read(dataset(Kind::kind, i), array.components * rows.size);
    const auto found = rows_of_keys(mesh.comm, keys, share.first, Kind::keys(mesh, array));
    together(mesh.comm, [&] {
      if (!Kind::has_group(mesh, array) || std::find(found.begin(), found.end(), -1) != found.end())
        refuse(path, "its " + Kind::description(array) + " is not that of this mesh");
    });
    const auto ranges = row_ranges(mesh.comm, rows_in_file, std::vector<PetscInt>(found.begin(), found.end()));
    std::vector<PetscInt> wanted;
    for (std::size_t f = 0; f < found.size(); ++f) {
      array.rows.push_back(static_cast<std::int32_t>(ranges[2 * f + 1]));
      for (std::int32_t row = 0; row < array.rows.back(); ++row)
        wanted.push_back(static_cast<PetscInt>(ranges[2 * f]) + row);
    }
    array.values = picked(mesh.comm, array.components, std::move(in_file), wanted);
    Kind::arrays(checkpoint)[file.read_string(root, attribute(Kind::kind, i, "name"))] = std::move(array);
  }
}

void read_global(Hdf5File& file, MPI_Comm comm, Checkpoint& checkpoint) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  const auto count = static_cast<std::size_t>(file.read_integer(root, "global_count"));
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = file.read_string(root, attribute("global", i, "name"));
    const std::int64_t size = file.read_integer(root, attribute("global", i, "size"));
    auto values = file.read(dataset("global", i), rank == 0 ? size : 0);
    values.resize(static_cast<std::size_t>(size));
    MPI_Bcast(values.data(), static_cast<int>(size), MPI_DOUBLE, 0, comm);
    checkpoint.global[name] = std::move(values);
  }
}

} // namespace

void write_checkpoint(const Mesh& mesh, const std::string& path, const std::string& identity,
                      const Checkpoint& checkpoint) {
  const std::string unfinished = path + ".unfinished";
  on_root(mesh.comm, [&] {
    if (!std::ofstream(unfinished, std::ios::trunc))
      throw UserError("The checkpoint " + unfinished + " cannot be written. Choose another directory with --out.");
  });
  Hdf5File file(mesh.comm, unfinished, FileUse::Create);
  write_contents(file, mesh, identity, checkpoint);
  file.finish();
  on_root(mesh.comm, [&] { rename_synchronized(unfinished, path); });
}

Checkpoint read_checkpoint(const Mesh& mesh, const std::string& path, const std::string& identity) {
  on_root(mesh.comm, [&] {
    if (!std::ifstream(path)) refuse(path, "there is no such file, or it may not be read");
    if (!is_sound_hdf5(path)) refuse(path, "it is not an HDF5 file, or it is damaged");
  });
  Hdf5File file(mesh.comm, path, FileUse::Read);
  check_identity(file, mesh, path, identity);
  Checkpoint checkpoint;
  checkpoint.time = file.read_double(root, "time");
  checkpoint.step = static_cast<int>(file.read_integer(root, "step"));
  checkpoint.increment = static_cast<int>(file.read_integer(root, "increment"));
  checkpoint.next_increment = file.read_double(root, "next_increment");
  read_nodal(file, mesh, path, checkpoint);
  read_rows<FacetRows>(file, mesh, path, checkpoint);
  read_rows<CellRows>(file, mesh, path, checkpoint);
  read_global(file, mesh.comm, checkpoint);
  file.finish();
  return checkpoint;
}

} // namespace amontons
