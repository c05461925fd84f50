// gmsh in process: opened for one mesh, silent, deterministic, its complaints collected. Everything that calls gmsh
// does so inside the life of a GmshSession.
#pragma once

#include "mesh/build.hpp"

#include <exception>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace amontons {

/// gmsh initialized for the life of the object with the given constants for .geo scripts. One at a time in a process.
class GmshSession {
 public:
  explicit GmshSession(const std::map<std::string, double>& parameters);
  ~GmshSession();
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;

  /// Runs `work` (gmsh calls) and throws a UserError with gmsh's own messages when it reports errors; `doing` begins
  /// the message: "Mesh file 'a.geo' cannot be read".
  template <class Work>
  void run(const std::string& doing, Work&& work) {
    std::string thrown;
    try {
      work();
    } catch (const std::string& message) {
      thrown = message;
    } catch (const std::exception& error) { // a size in the file that no memory holds: std::bad_alloc
      thrown = error.what();
    }
    fail_on_errors(doing, thrown);
  }

 private:
  void fail_on_errors(const std::string& doing, const std::string& thrown);
};

/// (dimension, name) of the physical groups that a file declares, also of those without elements.
using DeclaredGroups = std::set<std::pair<int, std::string>>;

/// Opens the source's file; meshes a .geo up to the dimension of its model, unless the script has done so itself;
/// brings all elements to source.order (absent: 1 for a .geo, as they are for a .msh). Throws UserError.
DeclaredGroups load_model(GmshSession& session, const MeshSource& source);

} // namespace amontons
