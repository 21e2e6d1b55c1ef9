// bess-sim refuses senseless command lines before it listens: one clear line, exit code 2 for a bad
// command line and 1 for bad input.
#include "tests/support/bad_command_lines.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

// GOOD is a minute file, DAY a day-ahead file, MAPS the folder of the register maps, NONE nothing,
// FOLDER a folder, EMPTY and GARBAGE files.
constexpr BadCommandLine kCases[] = {
    {"", 2, "bess-sim --help"},
    {"batery", 2, "battery bess-sim --help"},
    {"simulate", 2, "simulate bess-sim --help"},
    {"market", 2, "--prices bess-sim market --help"},
    {"settle", 2, "bess-sim settle --help"},
    {"battery now", 2, "now bess-sim battery --help"},
    {"battery --prot 1502", 2, "--prot --port bess-sim battery"},
    {"battery --port", 2, "--port"},
    {"battery --port 65536", 2, "--port"},
    {"battery --host localhost", 2, "--host"},
    {"battery --clients-max 0", 2, "--clients-max"},
    {"battery --response-delay-ms -1", 2, "--response-delay-ms"},
    {"battery --soc 1.5", 2, "--soc 1.5 0 1"},
    {"battery --soc nan", 2, "--soc nan 0 1"},
    {"battery --power-w 0", 2, "--power-w 0"},
    {"battery --capacity-wh -8000", 2, "--capacity-wh -8000 0"},
    {"battery --efficiency 0", 2, "--efficiency 0.01 1"},
    {"battery --efficiency 1.1", 2, "--efficiency 1.1 0.01 1"},
    {"battery --time-constant-s -1", 2, "--time-constant-s -1 0 600"},
    {"battery --time-scale 0", 2, "--time-scale"},
    {"battery --parity mark", 2, "--parity"},
    {"battery --stop-bits 3", 2, "--stop-bits"},
    {"battery --exception-code 0", 2, "--exception-code"},
    {"battery --fault-seed -1", 2, "--fault-seed"},
    // Contradictory options, or options that need a missing one.
    {"battery --serial NONE --port 1502", 2, "--serial --port"},
    {"battery --baud 9600", 2, "--baud --serial"},
    {"battery --parity even", 2, "--parity --serial"},
    {"battery --stop-bits 2", 2, "--stop-bits --serial"},
    {"battery --fault-every 3", 2, "--fault-every --fault"},
    {"battery --fault-probability 0.1", 2, "--fault-probability --fault"},
    {"battery --fault-seed 3", 2, "--fault-seed --fault"},
    {"battery --fault-from-s 60", 2, "--fault-from-s --fault"},
    {"battery --late-ms 60", 2, "--late-ms --fault"},
    {"battery --fault drop --fault-every 3 --fault-probability 0.1", 2,
     "--fault-every --fault-probability"},
    {"battery --fault drop --fault-from-s 60 --fault-to-s 60", 1, "--fault-to-s 60"},
    {"battery --fault drop --fault-on-s 60", 1, "--fault-off-s"},
    {"battery --fault drop --fault-off-s 60", 2, "--fault-off-s --fault-on-s"},
    {"battery --fault crc", 2, "crc"},
    {"battery --fault bad-crc", 1, "bad-crc"},
    {"battery --soc-min 0.9 --soc-max 0.1", 1, "--soc-min 0.9 --soc-max 0.1"},
    {"battery --house-seed 3", 2, "--house-seed --house"},
    {"battery --meter-map MAPS/../meters/sunspec.toml", 2, "--meter-map --house"},
    {"battery --house daily --meter-port 1503", 2, "--meter-port --meter-map"},
    {"battery --house daily --meter-fault silence", 2, "--meter-fault --meter-map"},
    {"battery --house daily --meter-map MAPS/alphaess.toml --port 0", 1, "alphaess.toml"},
    {"battery --house daily --meter-map MAPS/../meters/sunspec.toml --port 1502 --meter-port 1502",
     1, "--meter-port --port"},
    {"battery --house always", 1, "always"},
    {"battery --time-scale 900", 2, "--time-scale --utc-start"},
    {"battery --anchor-monotonic-ns 5", 2, "--anchor-monotonic-ns --utc-start"},
    {"battery --utc-start yesterday", 1, "yesterday"},
    {"battery --power-w 1e9", 1, "alphaess"},
    // Files.
    {"battery --map NONE", 1, "NONE"},
    {"battery --map GARBAGE", 1, "GARBAGE:1"},
    {"battery --map MAPS/alphaess.toml --variant next", 1, "next"},
    {"battery --record FOLDER", 1, "FOLDER"},
    {"battery --record -", 1, "./-"},
    {"battery --map GARBAGE --record GARBAGE", 1, "GARBAGE"},
    {"battery --serial NONE", 1, "NONE"},
    {"market --prices GARBAGE", 1, "GARBAGE"},
    {"market --prices GOOD --fault-every 3", 2, "--fault-every --fault"},
    {"market --prices GOOD --latency-s -1", 2, "--latency-s -1 0 3600"},
    {"market --prices GOOD --tls-cert NONE", 2, "--tls-cert --tls-key"},
    {"market --prices GOOD --tls-key NONE", 2, "--tls-key --tls-cert"},
    {"market --prices GOOD --port 0 --tls-cert NONE --tls-key NONE", 1, "NONE"},
    {"market --prices GOOD --port 0 --host nowhere.invalid", 1, "nowhere.invalid"},
    {"market --prices GOOD --day-ahead GOOD", 1, "GOOD:1"},
    {"market --prices GOOD --day-ahead-at 13:00", 2, "--day-ahead-at --day-ahead"},
    {"market --prices GOOD --day-ahead DAY --day-ahead-at 24:00", 1, "--day-ahead-at 24:00"},
    {"market --prices GOOD --day-ahead-fault late", 2, "--day-ahead-fault --day-ahead"},
    {"market --prices GOOD --day-ahead DAY --day-ahead-fault stale", 2, "--day-ahead-fault"},
    {"market --prices GOOD --day-ahead DAY --day-ahead-repair-s 60", 2, "--day-ahead-fault"},
    {"settle --record NONE --edge-log NONE --prices GOOD", 1, "NONE"},
    {"settle --record GOOD --edge-log GOOD --prices GOOD", 1, "GOOD"},
    {"clock --in-s -1", 2, "--in-s -1 0 86400"},
};

TEST(BadSimCommandLine, EachIsRefusedInOneLineBeforeAnythingListens) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("FOLDER"));
  const std::map<std::string, std::string> files{
      {"MAPS", BESS_SOURCE_DIR "/edge/device/maps"},
      {"GOOD", folder.write("GOOD",
                            "minute_utc,indicative_eur_mwh,settled_eur_mwh\n"
                            "2023-01-01T00:00:00Z,1.0,2.0\n2023-01-01T00:01:00Z,1.5,2.0\n")},
      {"DAY", folder.write("DAY",
                           "quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc\n"
                           "2023-01-01T00:00:00Z,1.0,60,\n")},
      {"EMPTY", folder.write("EMPTY", "")},
      {"GARBAGE", folder.write("GARBAGE", "\x7f ELF, or something \x01\x02 like that\n")},
      {"FOLDER", folder.file("FOLDER")},
      {"NONE", folder.file("NONE")}};
  EXPECT_GE(std::size(kCases), 70u);
  for (const BadCommandLine& line : kCases) expect_refused(BESS_SIM_PROGRAM, line, files);
}

}  // namespace
}  // namespace bess
