// The certificate of a run: each accepted state checked by lib/accuracy, the worst of every item kept.
#pragma once

#include "accuracy/certificate.hpp"
#include "ledger.hpp"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace amontons {

/// Checks the accepted state. Collective.
Certificate certify_state(Scene& scene, Ledger& ledger, const std::vector<ContactSamples>& samples, Vec accepted,
                          Vec unknowns);

/// The worst value of each item over the increments of a run. Not collective.
class CertificateRecord {
 public:
  /// Returns whether this certificate passed.
  bool add(const Certificate& certificate, double time);
  bool passed() const { return failed_increments_ == 0; }
  nlohmann::ordered_json to_json() const;
  /// What failed and what to do about it: a line for each item.
  std::vector<std::string> failures(const Deck& deck) const;

 private:
  struct Worst {
    Certificate::Item item;
    double time;
  };
  std::vector<Worst> worst_;
  int failed_increments_ = 0;
};

} // namespace amontons
