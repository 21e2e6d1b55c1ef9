// bess-train sweep packages: Debian packages by class of fleet members, and an Ansible inventory.
#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/sweep/class_packages.h"
#include "workstation/runs/sweep/sweep_plan.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

struct PackagesArguments {
  std::string folder, out, source = ".";
  std::vector<std::string> architectures{"arm64"};
  bool partial = false;
};

void package_sweep(const PackagesArguments& options) {
  if (!fs::exists(fs::path(options.source) / "tools/package"))
    fail(
        "{}: no tools/package here: packages are compiled from a source checkout; name it with "
        "--source DIR",
        options.source);
  const PackageRequest request{fs::canonical(options.source), fs::absolute(options.out),
                               options.architectures};
  const SweepFolder folder{options.folder};
  const auto tasks = collect_tasks(folder, load_tasks(folder));
  const std::vector<Site> sites = load_sites(folder);
  if (sites.empty())
    fail("{}: planned without --sites, so it has no classes; plan it with --sites", options.folder);
  auto classes = classes_to_package(tasks, collect_sites(folder, tasks, sites), options.partial);
  for (PackagedClass& one : classes) {
    const bool is_new = package_class(folder, request, one);
    fmt::print("class {}: student {}, {}: {}{}\n", one.name, one.student,
               counted(one.sites.size(), "site"), one.version, is_new ? "" : " exists already");
    std::fflush(stdout);
  }
  const fs::path inventory = fs::path(options.out) / "inventory.yml";
  write_file(inventory, format_inventory(classes, options.architectures.front()));
  fmt::print("{}: {}\n", inventory.string(), counted(classes.size(), "student"));
}

}  // namespace

void add_sweep_packages(ProgramCommand& sweep) {
  auto options = std::make_shared<PackagesArguments>();
  ProgramCommand command = sweep.subcommand(
      "packages",
      "Debian packages of bess-edge by class of fleet members, and an Ansible inventory");
  command.option("folder", options->folder, "folder of the sweep").value_name("DIR").required();
  command.option("--out", options->out, "output folder for inventory.yml and one folder per class")
      .value_name("DIR")
      .required();
  command
      .option("--arch", options->architectures,
              "architectures; most machines have the first (default arm64)")
      .one_of({"arm64", "armhf", "amd64"});
  command.option("--source", options->source, "source checkout, with tools/package").with_default();
  command.flag("--partial", options->partial, "skip fleet members without a proved student");
  command.footer(
      "Existing packages of the same student are kept.\n"
      "Example:\n  bess-train sweep packages sweeps/fleet --out debs --arch arm64 armhf --source "
      "~/bess");
  command.runs([options] { package_sweep(*options); });
}

}  // namespace bess
