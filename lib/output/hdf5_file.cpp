#include "output/hdf5_file.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

namespace amontons {

namespace {

constexpr int part_tag = 4711;

/// An HDF5 identifier, closed at the end of the scope.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Files are closed here, so there is nothing for HDF5 to do at the end of the program, where it crashes over a file
/// that could not be closed. Must be its first call.
void leave_files_at_exit() { [[maybe_unused]] static const herr_t done = H5dont_atexit(); }

bool a_file_is_stuck = false;

/// HDF5 prints its error stack unless told not to; here a failure is an answer or becomes a message of ours.
class Quiet {
 public:
  Quiet() {
    leave_files_at_exit();
    H5Eget_auto2(H5E_DEFAULT, &printer_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, printer_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t printer_ = nullptr;
  void* data_ = nullptr;
};

template <class Number>
hid_t memory_type() {
  if constexpr (std::is_same_v<Number, double>) return H5T_NATIVE_DOUBLE;
  return sizeof(Number) == 8 ? H5T_NATIVE_INT64 : H5T_NATIVE_INT32;
}

template <class Number>
MPI_Datatype message_type() {
  if constexpr (std::is_same_v<Number, double>) return MPI_DOUBLE;
  return MPIU_INT;
}

hid_t open_file(const std::string& path, FileUse use) {
  const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // Without this a viewer that has the file open would stop the run from adding to it.
  H5Pset_file_locking(access, false, true);
  if (use == FileUse::Create) return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  return H5Fopen(path.c_str(), use == FileUse::Read ? H5F_ACC_RDONLY : H5F_ACC_RDWR, access);
}

/// Property list of links that makes the groups on the way.
hid_t with_groups() {
  const hid_t properties = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(properties, 1);
  return properties;
}

bool exists(hid_t file, const std::string& path) {
  for (auto slash = path.find('/', 1); slash != std::string::npos; slash = path.find('/', slash + 1))
    if (H5Lexists(file, path.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
  return H5Lexists(file, path.c_str(), H5P_DEFAULT) > 0;
}

/// The group at `path`, made when it is missing.
hid_t open_group(hid_t file, const std::string& path) {
  if (exists(file, path)) return H5Gopen2(file, path.c_str(), H5P_DEFAULT);
  const Id links(with_groups(), H5Pclose);
  return H5Gcreate2(file, path.c_str(), links, H5P_DEFAULT, H5P_DEFAULT);
}

bool put_attribute(hid_t file, const std::string& group, const std::string& name, hid_t type, const void* value) {
  const Id at(open_group(file, group), H5Gclose);
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Id attribute(H5Acreate2(at, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return H5Awrite(attribute, type, value) >= 0;
}

hid_t string_type(std::size_t length) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  return type;
}

/// Rows first .. first + rows of a dataset's space as a selection, and the same block in memory.
void select_rows(hid_t space, hsize_t first, hsize_t rows) {
  hsize_t start[2] = {first, 0}, count[2] = {rows, 1};
  hsize_t dims[2] = {0, 1};
  if (H5Sget_simple_extent_ndims(space) == 2) H5Sget_simple_extent_dims(space, dims, nullptr);
  count[1] = dims[1];
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr);
}

/// The sizes of all ranks' parts, on rank 0.
std::vector<std::int64_t> part_sizes(MPI_Comm comm, int ranks, std::int64_t mine) {
  std::vector<std::int64_t> sizes(ranks);
  MPI_Gather(&mine, 1, MPI_INT64_T, sizes.data(), 1, MPI_INT64_T, 0, comm);
  return sizes;
}

} // namespace

Hdf5File::Hdf5File(MPI_Comm comm, const std::string& path, FileUse use)
    : comm_(comm), path_(path), reads_(use == FileUse::Read) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &ranks_);
  if (rank_ != 0) return;
  const Quiet quiet;
  file_ = open_file(path, use);
  expect(file_ >= 0, "it cannot be opened");
}

Hdf5File::~Hdf5File() {
  if (file_ >= 0) H5Fclose(file_);
}

void Hdf5File::expect(bool success, const std::string& what) {
  if (success || failed_) return;
  failed_ = true;
  failure_ = what;
}

void Hdf5File::finish() {
  on_root(comm_, [&] {
    const Quiet quiet;
    const bool closed = file_ < 0 || H5Fclose(file_) >= 0;
    file_ = H5I_INVALID_HID;
    expect(closed, "it cannot be closed");
    if (!closed) a_file_is_stuck = true;
    if (!failed_) return;
    throw UserError("The file " + path_ + " cannot be " + (reads_ ? "read: " : "written: ") + failure_ +
                    (reads_ ? "." : ". Is the disk full? Make room or choose another directory with --out."));
  });
}

template <class Number>
void Hdf5File::write_parts(const std::string& path, int components, std::span<const Number> part) {
  const auto sizes = part_sizes(comm_, ranks_, std::int64_t(part.size()));
  if (rank_ != 0) {
    MPI_Send(part.data(), static_cast<int>(part.size()), message_type<Number>(), 0, part_tag, comm_);
    return;
  }
  const Quiet quiet;
  const auto total = static_cast<hsize_t>(std::accumulate(sizes.begin(), sizes.end(), std::int64_t(0)));
  const hsize_t dims[2] = {total / components, hsize_t(components)};
  const Id space(H5Screate_simple(components > 1 ? 2 : 1, dims, nullptr), H5Sclose);
  const Id links(with_groups(), H5Pclose);
  const Id data(works() ? H5Dcreate2(file_, path.c_str(), memory_type<Number>(), space, links, H5P_DEFAULT, H5P_DEFAULT)
                        : H5I_INVALID_HID,
                H5Dclose);
  expect(data >= 0, "the dataset " + path + " cannot be made");
  std::vector<Number> received;
  hsize_t first = 0;
  for (int rank = 0; rank < ranks_; ++rank) {
    std::span<const Number> values = part;
    if (rank > 0) { // taken also after a failure: the sender waits
      received.resize(sizes[rank]);
      MPI_Recv(received.data(), static_cast<int>(sizes[rank]), message_type<Number>(), rank, part_tag, comm_,
               MPI_STATUS_IGNORE);
      values = received;
    }
    if (values.empty() || !works()) continue;
    const hsize_t size = values.size(), rows = size / components;
    const Id memory(H5Screate_simple(1, &size, nullptr), H5Sclose);
    select_rows(space, first, rows);
    expect(H5Dwrite(data, memory_type<Number>(), memory, space, H5P_DEFAULT, values.data()) >= 0,
           "the dataset " + path + " cannot be written");
    first += rows;
  }
}

void Hdf5File::write(const std::string& path, int components, std::span<const double> part) {
  write_parts(path, components, part);
}

void Hdf5File::write(const std::string& path, std::span<const PetscInt> part) { write_parts(path, 1, part); }

std::vector<double> Hdf5File::read(const std::string& path, std::int64_t size) {
  const auto sizes = part_sizes(comm_, ranks_, size);
  std::vector<double> mine(size);
  if (rank_ != 0) {
    MPI_Recv(mine.data(), static_cast<int>(size), MPI_DOUBLE, 0, part_tag, comm_, MPI_STATUS_IGNORE);
    return mine;
  }
  const Quiet quiet;
  const Id data(works() ? H5Dopen2(file_, path.c_str(), H5P_DEFAULT) : H5I_INVALID_HID, H5Dclose);
  const Id space(data >= 0 ? H5Dget_space(data) : H5I_INVALID_HID, H5Sclose);
  const auto total = std::accumulate(sizes.begin(), sizes.end(), std::int64_t(0));
  expect(space >= 0 && H5Sget_simple_extent_npoints(space) == total,
         "it has no dataset " + path + " of the right size");
  hsize_t dims[2] = {0, 1};
  if (works()) H5Sget_simple_extent_dims(space, dims, nullptr);
  hsize_t first = 0;
  for (int rank = 0; rank < ranks_; ++rank) {
    std::vector<double> other(rank == 0 ? 0 : sizes[rank]);
    std::vector<double>& values = rank == 0 ? mine : other;
    if (works() && !values.empty()) {
      const hsize_t count = values.size(), rows = count / dims[1];
      const Id memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
      select_rows(space, first, rows);
      expect(H5Dread(data, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()) >= 0,
             "the dataset " + path + " cannot be read");
      first += rows;
    }
    if (rank > 0) MPI_Send(values.data(), static_cast<int>(sizes[rank]), MPI_DOUBLE, rank, part_tag, comm_);
  }
  return mine;
}

void Hdf5File::write_attribute(const std::string& group, const std::string& name, double value) {
  if (!works()) return;
  const Quiet quiet;
  expect(put_attribute(file_, group, name, H5T_NATIVE_DOUBLE, &value), "the attribute " + name + " cannot be written");
}

void Hdf5File::write_attribute(const std::string& group, const std::string& name, std::int64_t value) {
  if (!works()) return;
  const Quiet quiet;
  expect(put_attribute(file_, group, name, H5T_NATIVE_INT64, &value), "the attribute " + name + " cannot be written");
}

void Hdf5File::write_attribute(const std::string& group, const std::string& name, const std::string& value) {
  if (!works()) return;
  const Quiet quiet;
  const Id type(string_type(value.size()), H5Tclose);
  expect(put_attribute(file_, group, name, type, value.c_str()), "the attribute " + name + " cannot be written");
}

double Hdf5File::read_double(const std::string& group, const std::string& name) {
  double value = 0.0;
  if (works()) {
    const Quiet quiet;
    const Id attribute(H5Aopen_by_name(file_, group.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    expect(H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) >= 0, "it has no attribute " + name);
  }
  MPI_Bcast(&value, 1, MPI_DOUBLE, 0, comm_);
  return value;
}

std::int64_t Hdf5File::read_integer(const std::string& group, const std::string& name) {
  std::int64_t value = 0;
  if (works()) {
    const Quiet quiet;
    const Id attribute(H5Aopen_by_name(file_, group.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    expect(H5Aread(attribute, H5T_NATIVE_INT64, &value) >= 0, "it has no attribute " + name);
  }
  MPI_Bcast(&value, 1, MPI_INT64_T, 0, comm_);
  return value;
}

std::string Hdf5File::read_string(const std::string& group, const std::string& name) {
  std::string value;
  if (works()) {
    const Quiet quiet;
    const Id attribute(H5Aopen_by_name(file_, group.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    const Id stored(attribute >= 0 ? H5Aget_type(attribute) : H5I_INVALID_HID, H5Tclose);
    const std::size_t length = stored >= 0 ? H5Tget_size(stored) : 0;
    value.resize(length);
    expect(length > 0 && H5Aread(attribute, stored, value.data()) >= 0, "it has no attribute " + name);
    value.resize(std::min(value.find('\0'), value.size()));
  }
  auto length = static_cast<int>(value.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, comm_);
  value.resize(static_cast<std::size_t>(length));
  MPI_Bcast(value.data(), length, MPI_CHAR, 0, comm_);
  return value;
}

bool Hdf5File::has_group(const std::string& path) {
  int has = 0;
  if (works()) {
    const Quiet quiet;
    has = exists(file_, path);
  }
  MPI_Bcast(&has, 1, MPI_INT, 0, comm_);
  return has != 0;
}

bool has_stuck_hdf5_file() { return a_file_is_stuck; }

bool is_sound_hdf5(const std::string& path) {
  const Quiet quiet;
  const Id file(open_file(path, FileUse::Read), H5Fclose);
  return file >= 0;
}

} // namespace amontons
