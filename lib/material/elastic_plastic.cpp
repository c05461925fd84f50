#include "material/elastic_plastic.hpp"

#include "deck/shared_rule.hpp"
#include "material/elastic_rule.hpp"

namespace amontons {

double kinematic_modulus(const ElasticPlastic& material) {
  return material.kinematic ? std::visit([](const Prager& law) { return law.H; }, *material.kinematic) : 0.0;
}

Rule<ElasticPlastic> elastic_plastic_rule() {
  const Rule<Prager> prager = shared(Rule<Prager>(ObjectRule<Prager>().required(
      "H", &Prager::H, number("stress", Range::above(0)), "Slope of backstress over plastic strain, uniaxial.")));
  const Rule<Perzyna> perzyna = shared(Rule<Perzyna>(
      ObjectRule<Perzyna>()
          .required("D", &Perzyna::D, number("1 / time", Range::above(0)),
                    "Plastic rate that doubles the yield stress.")
          .required("n", &Perzyna::n, number("1", Range::at_least(1)), "Exponent: rate = D (q / yield - 1)^n.")));
  const Rule<KinematicHardening> kinematic = TaggedRule<KinematicHardening>().tag(
      "prager", prager, "Linear kinematic hardening.", "W. Prager, Proc. Inst. Mech. Eng. 169 (1955) 41-57.");
  const Rule<RateDependence> rate =
      TaggedRule<RateDependence>().tag("perzyna", perzyna, "Overstress by a power of the rate (Cowper-Symonds).",
                                       "P. Perzyna, Adv. Appl. Mech. 9 (1966) 243-377.");
  return elastic_rule<ElasticPlastic>(&ElasticPlastic::elastic)
      .required("hardening", &ElasticPlastic::hardening, shared(hardening_rule()), "Yield stress over plastic strain.")
      .optional("kinematic", &ElasticPlastic::kinematic, shared(kinematic), "Kinematic hardening; left out: none.")
      .optional("rate", &ElasticPlastic::rate, shared(rate), "Rate dependence; left out: none.");
}

} // namespace amontons
