// Rectangular blocks of quadrilaterals or hexahedra, partitioned by hand: scenes with exact solutions for the
// certificate. The vertical axis is the last one.
#pragma once

#include "accuracy/certificate.hpp"

#include <functional>
#include <string>
#include <vector>

namespace amontons::testing {

struct Block {
  std::string name;
  std::array<double, 3> low, high;
  std::array<int, 3> cells;
};

/// Cells are dealt to the ranks in turn. Surfaces of block b: b_bottom, b_top, b_sides. With `welded`, nodes at the
/// same place are the same node.
Mesh block_mesh(MPI_Comm comm, int dim, const std::vector<Block>& blocks, bool welded = false);

/// A scene and what a solver would claim about it, to be broken by the tests.
struct Case {
  Mesh mesh;
  Space space = Space::Solid;
  std::vector<double> displacement, external; // the displacement comes in one increment
  std::vector<ContactPairNames> pairs;
  std::vector<ContactSamples> samples;
  std::vector<SupportedComponent> supports;
  EnergyLedger energy;
  double force_floor = 0.0;
  Kinematics kinematics = Kinematics::Small;

  Certificate certify() const;
};

using Field = std::function<std::array<double, 3>(const std::array<double, 3>&)>;

/// Displacement at the nodes.
void displace(Case& scene, const Field& u);

/// Adds ∫ traction over a surface to the external forces.
void load(Case& scene, const std::string& surface, const std::array<double, 3>& traction);

/// Samples of a slave surface with a uniform pressure along `normal`, at points and nodes.
ContactSamples uniform_samples(const Mesh& mesh, const std::string& slave, double pressure,
                               const std::array<double, 3>& normal);

/// Two blocks of unit sides, one on the other with different meshes, without Poisson effect, compressed by 1 % by a
/// pressure of 1 on the upper one: u = -0.01 z, E = 100. The upper block's bottom is the slave.
Case compressed_blocks(MPI_Comm comm, int dim);

/// The same with friction of mu = 0.3: the upper block is also stretched sideways by 2 %, about its middle, so that its
/// bottom slides outwards on both sides and the shear of 0.3 on it points inwards, without a resultant.
Case stretched_block(MPI_Comm comm, int dim);

const Certificate::Item& item(const Certificate& certificate, const std::string& name);

/// Names of the items that failed.
std::vector<std::string> failures(const Certificate& certificate);

} // namespace amontons::testing
