// PETSc objects owned by C++ scopes, and PETSc error codes turned into exceptions and back at the border of a callback.
#pragma once

#include <exception>
#include <petscdm.h>
#include <petscksp.h>
#include <petscsf.h>
#include <petscsnes.h>
#include <stdexcept>
#include <utility>

namespace amontons {

/// A PETSc call failed; PETSc has already printed its trace. A fault of the program or of the options, not of the deck.
class PetscFailure : public std::runtime_error {
 public:
  PetscFailure(PetscErrorCode code, const char* call, const char* file, int line);
  PetscErrorCode code() const { return code_; }

 private:
  PetscErrorCode code_;
};

inline void petsc_check(PetscErrorCode code, const char* call, const char* file, int line) {
  if (code != 0) [[unlikely]]
    throw PetscFailure(code, call, file, line);
}

/// Calls PETSc and throws PetscFailure on an error code. Never inside a PETSc callback without `guarded`.
#define AMT_PETSC(call) ::amontons::petsc_check((call), #call, __FILE__, __LINE__)

/// Sole owner of a PETSc object. Destruction is collective, as PETSc's.
template <class Object, PetscErrorCode (*Destroy)(Object*)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(Object object) : object_(object) {}
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { reset(); }

  void reset() {
    if (object_) Destroy(&object_);
    object_ = nullptr;
  }
  /// Where a PETSc create function puts the new object; frees what was held.
  Object* put() {
    reset();
    return &object_;
  }
  Object get() const { return object_; }
  operator Object() const { return object_; }

 private:
  Object object_ = nullptr;
};

using VecHandle = Handle<Vec, VecDestroy>;
using MatHandle = Handle<Mat, MatDestroy>;
using IsHandle = Handle<IS, ISDestroy>;
using ScatterHandle = Handle<VecScatter, VecScatterDestroy>;
using SfHandle = Handle<PetscSF, PetscSFDestroy>;
using SnesHandle = Handle<SNES, SNESDestroy>;
using KspHandle = Handle<KSP, KSPDestroy>;
using ViewerHandle = Handle<PetscViewer, PetscViewerDestroy>;
using DmHandle = Handle<DM, DMDestroy>;
using NullSpaceHandle = Handle<MatNullSpace, MatNullSpaceDestroy>;

/// Runs C++ code inside a PETSc callback: an exception is kept in `kept` for the caller of PETSc to rethrow and becomes
/// a PETSc error code, so that it does not unwind through C frames.
template <class Work>
PetscErrorCode guarded(std::exception_ptr& kept, Work&& work) noexcept {
  try {
    work();
    return 0;
  } catch (...) {
    kept = std::current_exception();
    return PETSC_ERR_LIB;
  }
}

/// Read and write access to the local part of a vector for the life of the scope.
class VecArray {
 public:
  explicit VecArray(Vec vec) : vec_(vec) {
    AMT_PETSC(VecGetArray(vec_, &data_));
    AMT_PETSC(VecGetLocalSize(vec_, &size_));
  }
  ~VecArray() { VecRestoreArray(vec_, &data_); }
  VecArray(const VecArray&) = delete;
  VecArray& operator=(const VecArray&) = delete;
  double& operator[](PetscInt i) { return data_[i]; }
  double* data() { return data_; }
  PetscInt size() const { return size_; }

 private:
  Vec vec_;
  double* data_ = nullptr;
  PetscInt size_ = 0;
};

/// Read access to the local part of a vector for the life of the scope.
class VecReader {
 public:
  explicit VecReader(Vec vec) : vec_(vec) {
    AMT_PETSC(VecGetArrayRead(vec_, &data_));
    AMT_PETSC(VecGetLocalSize(vec_, &size_));
  }
  ~VecReader() { VecRestoreArrayRead(vec_, &data_); }
  VecReader(const VecReader&) = delete;
  VecReader& operator=(const VecReader&) = delete;
  double operator[](PetscInt i) const { return data_[i]; }
  const double* data() const { return data_; }
  PetscInt size() const { return size_; }

 private:
  Vec vec_;
  const double* data_ = nullptr;
  PetscInt size_ = 0;
};

} // namespace amontons
