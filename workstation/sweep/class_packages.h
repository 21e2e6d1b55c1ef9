// From a sweep to the machines: each class of sites gets a folder with its header and its packages,
// which tools/package makes, and the sites an inventory for tools/ansible: of which class a site
// is, which student is expected there, and with which share of the fleet it is rolled out.
//
//   inventory.yml                    for ansible-playbook -i
//   CLASS/student_weights.h          of the class's first proved task, as in sites.csv
//   CLASS/decision_signature.txt     what a program with it decides
//   CLASS/bess-edge_VERSION_ARCH.deb
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "workstation/sweep/collected.h"

namespace bess {

struct PackageRequest {
  std::filesystem::path source;  ///< a checkout: tools/package is in it
  std::filesystem::path out;
  std::vector<std::string> architectures;  ///< as Debian names them; the first is the inventory's
  bool again = false;                      ///< also what is there already
};

/// Of one class, once its packages are made.
struct PackagedClass {
  std::string name;
  std::string student;  ///< under which hash its program tells it
  std::string version;
  std::vector<CollectedSite> sites;  ///< none is without a header
};

/// One element a class, in the order of their first site. Throws UserError where a site has no
/// proved student or its name cannot be one of a host; with `partial` those without are left out.
std::vector<PackagedClass> classes_to_package(const std::vector<CollectedTask>& tasks,
                                              const std::vector<CollectedSite>& sites,
                                              bool partial);

/// Makes the packages of one class unless they are there; false: they were. Throws UserError with
/// the last that tools/package said.
bool package_class(const SweepFolder& sweep, const PackageRequest& request, PackagedClass& one);

/// With which share of a fleet a site is rolled out: 1, 10 or 100 percent. By its id alone, so that
/// it stays when sites are added.
int rollout_percent(const std::string& id);

std::string format_inventory(const std::vector<PackagedClass>& classes,
                             const std::string& architecture);

}  // namespace bess
