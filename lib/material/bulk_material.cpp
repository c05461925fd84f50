#include "material/bulk_material.hpp"

#include "base/error.hpp"
#include "deck/shared_rule.hpp"
#include "material/elastic_rule.hpp"

namespace amontons {
namespace {

struct SmallLawOf {
  const std::string& name;
  SmallLaw operator()(const Elastic& law) const { return law; }
  SmallLaw operator()(const ElasticPlastic& material) const { return SmallPlastic{material}; }
  template <class Hyperelastic>
  SmallLaw operator()(const Hyperelastic&) const {
    throw UserError(name + " is a law of large strain and needs `kinematics: finite`; with `kinematics: small` use "
                           "`elastic`, which it equals at small strain.");
  }
};

struct FiniteLawOf {
  FiniteLaw operator()(const Elastic& elastic) const { return Hencky{elastic}; }
  FiniteLaw operator()(const ElasticPlastic& material) const { return FinitePlastic{material}; }
  template <class Hyperelastic>
  FiniteLaw operator()(const Hyperelastic& law) const {
    return law;
  }
};

} // namespace

SmallLaw small_law(const BulkMaterial& material, const std::string& name) {
  return std::visit(SmallLawOf{name}, material);
}

FiniteLaw finite_law(const BulkMaterial& material) { return std::visit(FiniteLawOf{}, material); }

double initial_stiffness(const BulkMaterial& material) { return young(initial_lame(finite_law(material))); }

Rule<BulkMaterial> bulk_material_rule() {
  TaggedRule<BulkMaterial> rule;
  rule.tag("elastic", elastic_rule<Elastic>(std::identity()),
           "Linear isotropic elasticity; in finite kinematics in logarithmic strain (Hencky).")
      .tag("elastic_plastic", shared(elastic_plastic_rule()), "Elastoplasticity after von Mises (J2).",
           "J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998).")
      .tag("st_venant_kirchhoff", st_venant_kirchhoff_rule(),
           "Linear between Green's strain and its stress: large rotations, small strains.")
      .tag("neo_hookean", neo_hookean_rule(), "Compressible neo-Hookean elasticity.",
           "J. C. Simo, K. S. Pister, Comput. Methods Appl. Mech. Eng. 46 (1984) 201-215.")
      .tag("mooney_rivlin", mooney_rivlin_rule(), "Mooney-Rivlin rubber, slightly compressible.",
           "R. S. Rivlin, Phil. Trans. R. Soc. A 241 (1948) 379-397.");
  return shared(Rule<BulkMaterial>(rule));
}

} // namespace amontons
