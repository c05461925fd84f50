// The XML that tells ParaView what the datasets of fields.h5 are: pure functions of names and numbers.
#pragma once

#include "math/element_type.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace amontons {

/// The order in which XDMF (and VTK) list the nodes of an element: entry k is the gmsh number of their node k. A
/// Hexahedron27 is listed as the Hexahedron_20 without its nodes on faces and in the middle: in a Mixed topology
/// ParaView reads no Hexahedron_27, and alone its two readers disagree about the order (tried with ParaView 5.11).
std::span<const int> xdmf_order(ElementType type);

/// The numbers that announce an element in a Mixed topology: its code and, for a Segment2 (a polyline there), its
/// length.
std::span<const int> xdmf_announcement(ElementType type);

/// A dataset of an HDF5 file beside the XDMF file.
struct XdmfData {
  std::string path; // "fields.h5:/run0/mesh/coordinates"
  std::int64_t rows = 0;
  int columns = 1;
  bool is_integer = false;
};

struct XdmfAttribute {
  std::string name;
  std::string type;   // Scalar, Vector, Matrix
  std::string center; // Node, Cell
  XdmfData data;
};

struct XdmfGrid {
  std::string name;
  std::int64_t num_cells = 0;
  bool is_cloud = false; // points only: the topology lists them
  XdmfData topology;     // otherwise Mixed
  XdmfData geometry;     // num_points x 3
  std::vector<XdmfAttribute> attributes;
};

/// What comes before the first and after the last time step of a file.
std::string xdmf_head(const std::string& title);
std::string xdmf_tail();

/// One time step: begins with a comment line that xdmf_steps_until recognizes.
std::string xdmf_step(double time, const std::vector<XdmfGrid>& grids);

/// The steps of a whole file that are not later than `time`, as text, and how many they are.
struct XdmfSteps {
  std::string text;
  int count = 0;
};
XdmfSteps xdmf_steps_until(const std::string& file, double time);

} // namespace amontons
