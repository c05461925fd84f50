// Distributed arrays and small attributes in one HDF5 file, through PETSc's viewer: every rank writes and reads its own
// part. Paths are absolute ("/run0/mesh/coordinates"); groups appear as they are needed.
#pragma once

#include "base/petsc.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace amontons {

enum class FileUse { Create, Append, Read };

/// An open file; closing it (the end of the scope) puts everything on disk. All members are collective unless they say
/// otherwise; arrays are the concatenation of the ranks' parts in rank order.
class Hdf5File {
 public:
  Hdf5File(MPI_Comm comm, const std::string& path, FileUse use);

  /// A dataset of (global size / components) x components numbers, one-dimensional for one component. An array that is
  /// empty on all ranks is not written, for a dataset cannot have chunks of size zero.
  void write(const std::string& path, int components, std::span<const double> part);
  void write(const std::string& path, std::span<const PetscInt> part);
  /// `size`: how many numbers (rows x components) this rank takes; the ranks' sizes must add up to the dataset's.
  std::vector<double> read(const std::string& path, int components, PetscInt size);

  void write_attribute(const std::string& group, const std::string& name, double value);
  void write_attribute(const std::string& group, const std::string& name, PetscInt value);
  void write_attribute(const std::string& group, const std::string& name, const std::string& value);
  double read_double(const std::string& group, const std::string& name);
  PetscInt read_integer(const std::string& group, const std::string& name);
  std::string read_string(const std::string& group, const std::string& name);
  bool has_group(const std::string& path);

 private:
  MPI_Comm comm_;
  ViewerHandle viewer_;
};

/// Whether the HDF5 library can open the file: false for a missing, foreign, cut or damaged one. Serial.
bool is_sound_hdf5(const std::string& path);

} // namespace amontons
