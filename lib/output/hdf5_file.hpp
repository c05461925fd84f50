// Distributed arrays and small attributes in one HDF5 file. Rank 0 alone touches the file: it takes the ranks' parts
// one after the other and puts each in its place, so that no rank ever holds a whole array.
//
// Why not PETSc's parallel viewer: every dataset made through MPI-IO costs several collective operations and a flush.
// On 2 busy cores a step of 15 datasets took 0.1 s on 1 rank and 0.5 to 1.8 s on 2, for 2,000 nodes as for 70,000; this
// way it takes 0.001 s and 0.02 to 0.08 s. Besides, a full disk becomes a message here and not a trace, and a user who
// looks at the file does not lock the run out of it.
#pragma once

#include "base/petsc.hpp"

#include <cstdint>
#include <hdf5.h>
#include <span>
#include <string>
#include <vector>

namespace amontons {

enum class FileUse { Create, Append, Read };

/// A file that is open until finish() or the end of the scope. Paths are absolute ("/run0/mesh/coordinates"); groups
/// appear as they are needed. All members are collective. Arrays are the concatenation of the ranks' parts in rank
/// order. After a failure nothing more is done to the file, reads give zeros, and finish() tells.
class Hdf5File {
 public:
  Hdf5File(MPI_Comm comm, const std::string& path, FileUse use);
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  /// Closes the file, with everything handed to the operating system. Throws UserError on every rank when anything has
  /// gone wrong since the file was opened.
  void finish();

  /// A dataset of (global size / components) x components numbers, one-dimensional for one component.
  void write(const std::string& path, int components, std::span<const double> part);
  void write(const std::string& path, std::span<const PetscInt> part);
  /// `size`: how many numbers (rows x components) this rank takes; the ranks' sizes must add up to the dataset's.
  std::vector<double> read(const std::string& path, std::int64_t size);

  void write_attribute(const std::string& group, const std::string& name, double value);
  void write_attribute(const std::string& group, const std::string& name, std::int64_t value);
  void write_attribute(const std::string& group, const std::string& name, const std::string& value);
  double read_double(const std::string& group, const std::string& name);
  std::int64_t read_integer(const std::string& group, const std::string& name);
  std::string read_string(const std::string& group, const std::string& name);
  bool has_group(const std::string& path);

 private:
  template <class Number>
  void write_parts(const std::string& path, int components, std::span<const Number> part);
  bool works() const { return rank_ == 0 && !failed_; }
  void expect(bool success, const std::string& what);

  MPI_Comm comm_;
  int rank_ = 0, ranks_ = 1;
  std::string path_;
  bool reads_ = false;
  hid_t file_ = H5I_INVALID_HID; // rank 0
  bool failed_ = false;          // rank 0
  std::string failure_;
};

/// Whether a file on this rank could not be closed, as on a full disk. HDF5 (1.10) keeps it, tries again in
/// MPI_Finalize and crashes: such a program must end by MPI_Abort. Serial.
bool has_stuck_hdf5_file();

/// Whether the HDF5 library can open the file: false for a missing, foreign, cut or damaged one. Serial.
bool is_sound_hdf5(const std::string& path);

} // namespace amontons
