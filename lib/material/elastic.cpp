#include "material/elastic.hpp"

#include "base/error.hpp"

namespace amontons {
Lame lame_constants(const Elastic& material, Space space) {
  const auto [E, nu] = material;
  if (!(E > 0)) throw UserError("Young's modulus E = " + std::to_string(E) + " must be positive.");
  if (!(nu > -1 && nu < 0.5))
    throw UserError("Poisson's ratio nu = " + std::to_string(nu) +
                    " must lie between -1 and 0.5, both excluded; use 0.4999 for a nearly incompressible material.");
  const double G = E / (2 * (1 + nu));
  if (space == Space::PlaneStress) return {E * nu / (1 - nu * nu), G};
  return {E * nu / ((1 + nu) * (1 - 2 * nu)), G};
}

template <int dim>
Stress<dim> elastic_stress(const Lame& lame, Space space, const Strain<dim>& strain) {
  const bool free_zz = space == Space::PlaneStress;
  const double pressure_part = lame.lambda * (strain[0] + strain[1] + (free_zz ? 0.0 : strain[2]));
  Stress<dim> stress = lame.G * strain; // shears: G times the engineering strain
  for (int i = 0; i < 3; ++i)
    stress[i] = 2 * stress[i] + pressure_part;
  if (free_zz) stress[2] = 0;
  return stress;
}

template <int dim>
double elastic_energy(const Lame& lame, Space space, const Strain<dim>& strain) {
  return 0.5 * elastic_stress<dim>(lame, space, strain).dot(strain);
}

template <int dim>
Moduli<dim> elastic_moduli(const Lame& lame, Space space) {
  Moduli<dim> moduli = Moduli<dim>::Zero();
  moduli.template topLeftCorner<3, 3>().setConstant(lame.lambda);
  for (int i = 0; i < strain_size<dim>; ++i)
    moduli(i, i) += i < 3 ? 2 * lame.G : lame.G;
  if (space == Space::PlaneStress) {
    moduli.row(2).setZero();
    moduli.col(2).setZero();
  }
  return moduli;
}

double plane_stress_zz_strain(const Elastic& material, double xx, double yy) {
  return -material.poisson / (1 - material.poisson) * (xx + yy);
}

template Stress<2> elastic_stress<2>(const Lame&, Space, const Strain<2>&);
template Stress<3> elastic_stress<3>(const Lame&, Space, const Strain<3>&);
template double elastic_energy<2>(const Lame&, Space, const Strain<2>&);
template double elastic_energy<3>(const Lame&, Space, const Strain<3>&);
template Moduli<2> elastic_moduli<2>(const Lame&, Space);
template Moduli<3> elastic_moduli<3>(const Lame&, Space);

} // namespace amontons
