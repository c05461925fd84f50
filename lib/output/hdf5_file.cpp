#include "output/hdf5_file.hpp"

#include <algorithm>
#include <petscviewerhdf5.h>

namespace amontons {

namespace {

/// The group that the viewer works in for the life of the scope, and the last part of the path as the object's name.
class Location {
 public:
  Location(PetscViewer viewer, PetscObject object, const std::string& path) : viewer_(viewer) {
    const auto slash = path.rfind('/');
    AMT_PETSC(PetscViewerHDF5PushGroup(viewer_, path.substr(0, std::max<std::size_t>(slash, 1)).c_str()));
    AMT_PETSC(PetscObjectSetName(object, path.substr(slash + 1).c_str()));
  }
  ~Location() { PetscViewerHDF5PopGroup(viewer_); }
  Location(const Location&) = delete;
  Location& operator=(const Location&) = delete;

 private:
  PetscViewer viewer_;
};

PetscFileMode mode_of(FileUse use) {
  switch (use) {
  case FileUse::Create:
    return FILE_MODE_WRITE;
  case FileUse::Append:
    return FILE_MODE_APPEND;
  case FileUse::Read:
    break;
  }
  return FILE_MODE_READ;
}

bool empty_everywhere(MPI_Comm comm, std::size_t size) {
  const int mine = size > 0;
  int any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, comm);
  return any == 0;
}

} // namespace

Hdf5File::Hdf5File(MPI_Comm comm, const std::string& path, FileUse use) : comm_(comm) {
  AMT_PETSC(PetscViewerHDF5Open(comm, path.c_str(), mode_of(use), viewer_.put()));
}

void Hdf5File::write(const std::string& path, int components, std::span<const double> part) {
  if (empty_everywhere(comm_, part.size())) return;
  VecHandle vec;
  AMT_PETSC(VecCreateMPIWithArray(comm_, components, static_cast<PetscInt>(part.size()), PETSC_DECIDE, part.data(),
                                  vec.put()));
  const Location location(viewer_, PetscObject(vec.get()), path);
  AMT_PETSC(VecView(vec, viewer_));
}

void Hdf5File::write(const std::string& path, std::span<const PetscInt> part) {
  if (empty_everywhere(comm_, part.size())) return;
  IsHandle is;
  AMT_PETSC(ISCreateGeneral(comm_, static_cast<PetscInt>(part.size()), part.data(), PETSC_USE_POINTER, is.put()));
  const Location location(viewer_, PetscObject(is.get()), path);
  AMT_PETSC(ISView(is, viewer_));
}

std::vector<double> Hdf5File::read(const std::string& path, int components, PetscInt size) {
  if (empty_everywhere(comm_, std::size_t(size))) return {};
  VecHandle vec; // VecLoad replaces the array of a vector, so that reading in place is not possible
  AMT_PETSC(VecCreate(comm_, vec.put()));
  AMT_PETSC(VecSetSizes(vec, size, PETSC_DETERMINE));
  AMT_PETSC(VecSetBlockSize(vec, components));
  AMT_PETSC(VecSetType(vec, VECMPI));
  const Location location(viewer_, PetscObject(vec.get()), path);
  AMT_PETSC(VecLoad(vec, viewer_));
  const VecReader values(vec);
  return {values.data(), values.data() + values.size()};
}

void Hdf5File::write_attribute(const std::string& group, const std::string& name, double value) {
  AMT_PETSC(PetscViewerHDF5WriteAttribute(viewer_, group.c_str(), name.c_str(), PETSC_DOUBLE, &value));
}

void Hdf5File::write_attribute(const std::string& group, const std::string& name, PetscInt value) {
  AMT_PETSC(PetscViewerHDF5WriteAttribute(viewer_, group.c_str(), name.c_str(), PETSC_INT, &value));
}

void Hdf5File::write_attribute(const std::string& group, const std::string& name, const std::string& value) {
  AMT_PETSC(PetscViewerHDF5WriteAttribute(viewer_, group.c_str(), name.c_str(), PETSC_STRING, value.c_str()));
}

double Hdf5File::read_double(const std::string& group, const std::string& name) {
  double value = 0.0;
  AMT_PETSC(PetscViewerHDF5ReadAttribute(viewer_, group.c_str(), name.c_str(), PETSC_DOUBLE, nullptr, &value));
  return value;
}

PetscInt Hdf5File::read_integer(const std::string& group, const std::string& name) {
  PetscInt value = 0;
  AMT_PETSC(PetscViewerHDF5ReadAttribute(viewer_, group.c_str(), name.c_str(), PETSC_INT, nullptr, &value));
  return value;
}

std::string Hdf5File::read_string(const std::string& group, const std::string& name) {
  char* text = nullptr;
  AMT_PETSC(PetscViewerHDF5ReadAttribute(viewer_, group.c_str(), name.c_str(), PETSC_STRING, nullptr, &text));
  std::string value = text ? text : "";
  AMT_PETSC(PetscFree(text));
  return value;
}

bool Hdf5File::has_group(const std::string& path) {
  PetscBool has = PETSC_FALSE;
  AMT_PETSC(PetscViewerHDF5HasGroup(viewer_, path.c_str(), &has));
  return has == PETSC_TRUE;
}

bool is_sound_hdf5(const std::string& path) {
  // HDF5 prints its error stack unless told not to; here a failure is an answer.
  H5E_auto2_t printer = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &printer, &data);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file >= 0) H5Fclose(file);
  H5Eset_auto2(H5E_DEFAULT, printer, data);
  return file >= 0;
}

} // namespace amontons
