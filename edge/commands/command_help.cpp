#include "edge/commands/command_help.h"

namespace bess {
namespace {

constexpr const char* kRunHelp =
    R"(bess-edge: drives a battery on the imbalance price, every two minutes

  bess-edge [--config FILE] [--dry-run] [--cycles N] [--record FILE]    run
  bess-edge [--config FILE] --check                     what would be done; writes nothing
  bess-edge commission [--config FILE] --yes            check the sign of a new battery, once
  bess-edge release [--config FILE] --yes               end an order that nobody ends any more
  bess-edge clear [--config FILE] --yes                 drive again after the supervision tripped
  bess-edge status [--config FILE] ...                  how the running controller is
  bess-edge log [--config FILE] ...                     what was decided, and why
  bess-edge hold WATTS --for TIME [--config FILE]       a power until an end, whatever the price
  bess-edge limit [--config FILE] ...                   caps the power for a while
  bess-edge record --for TIME [--config FILE]           what the battery answers, to a file
  bess-edge map check --against FILE [--map FILE]       does a register map fit a recorded battery?
  bess-edge [--config FILE] --self-test                 can this machine run the controller here?
  bess-edge signature                                   one number for what this build decides
  bess-edge history                                     versions that this machine has run
  bess-edge help [COMMAND]                              this text, or more on one of them
  bess-edge version                                     version and the student that is built in

  --config FILE  settings in TOML; edge/bess-edge.toml documents every key; default /etc/bess/edge.toml
  --check        check settings, map, student and sign check, print the registers that would be
                 written, read the battery and the newest price once, write nothing, exit
  --self-test    try student, signature, memory, seal, clock, certificates, price server, storage and
                 battery once; a table, nothing is written to the battery
  --dry-run      run, but write nothing, whatever the file says (control = false does the same)
  --cycles N     stop cleanly after N cycles
  --record FILE  besides, write every request to the battery and its reply to FILE (see bess-edge
                 record --help): what bess-sim battery --replay plays again
  --help         this text; behind a command, more on that one
  --version      version and the student that is built in

Options may stand before the command or behind it. A run writes nothing to the battery unless the file
says control = true and `bess-edge commission` has found its sign right. One controller to one battery: a
second one is refused, also one that only reads (--check too), because many batteries serve one connection.
SIGTERM or Ctrl-C: 0 W is ordered, the battery is released, exit 0. SIGHUP: exit 0 and leave the order
in force for the next start, which takes over; the battery's own timer ends it if there is none.
Exit codes: 0 done   1 settings or battery are bad, the sign is not checked, the battery is in use, or was
not released at the end; with --check also: no price, clock not set by NTP; with --self-test: a part fails
2 the command line is bad

  bess-edge --config /etc/bess/edge.toml --check
  bess-edge --config /etc/bess/edge.toml --dry-run --cycles 5
)";

constexpr const char* kCommissionHelp =
    R"(bess-edge commission: checks once that a battery goes the way it is told

  bess-edge commission [--config FILE] --yes

  --config FILE  the controller's settings; default /etc/bess/edge.toml
  --yes          really order it: without it only what would be ordered is said

The battery rests for 10 s, then charges and discharges 500 W for 30 s each, then is released (the map's
[commissioning] may say otherwise). Its measured power must follow each way, no less and no more than
[response] of its map allows and as soon, and so must the meter of [meter]. A battery that is slower is
refused with the lines to set; a direction that its SoC leaves no room for is not tested, and said.
The result is kept in the [state] folder and holds for this
map, variant and address; bess-edge refuses to control a battery without it.
Exit codes: 0 passed   1 refused: the line says why   2 the command line is bad, or --yes is missing

  bess-edge commission --config /etc/bess/edge.toml --yes
)";

constexpr const char* kReleaseHelp =
    R"(bess-edge release: gives a battery back to its own mode, when a controller that is gone left an order

  bess-edge release [--config FILE] --yes [--force]

  --config FILE  the controller's settings; default /etc/bess/edge.toml
  --yes          really write it
  --force        also to a device that does not answer as its register map says

Needs no sign check. Refused while a bess-edge controls the battery: stop that instead.
Exit codes: 0 released   1 refused or failed: the line says why   2 the command line is bad, or --yes is missing

  systemctl stop bess-edge; bess-edge release --yes
)";

constexpr const char* kClearHelp =
    R"(bess-edge clear: a person has looked why the battery did not do what it was told

  bess-edge clear [--config FILE] --yes

  --config FILE  the controller's settings; default /etc/bess/edge.toml
  --yes          let it be driven again; without it only the trip is told

After wrong_direction, uncontrolled_power, soc_mismatch or state_lost the battery is in its own mode until this is
said, over restarts too. A running controller goes on at its next cycle.
Exit codes: 0 cleared, or nothing to clear   1 log or state cannot be accessed   2 the command line is
bad, or --yes is missing

  bess-edge log --last 10; bess-edge clear --yes
)";

constexpr const char* kStatusHelp =
    R"(bess-edge status: how the running controller is; touches neither battery nor controller

  bess-edge status [--config FILE] [--json | --prometheus] [--follow] [--no-lock]

  --config FILE  the controller's settings; default /etc/bess/edge.toml
  --json         one JSON object with "health"
  --prometheus   the metrics as the node exporter's textfile collector takes them
  --follow       again every two seconds, until Ctrl-C
  --no-lock      whether it runs is told by its process number alone: its lock is not even tried

Health is ok, degraded (with the reasons) or not running. A status older than two cycles is a WARN,
older than four CRITICAL. Of a controller that has ended, what it was last and when that was.
Exit codes: 0 ok   1 degraded, or the files cannot be read   2 the command line is bad   3 not running

  bess-edge status
  bess-edge status --json | jq .health
  watch -n 60 bess-edge status --config /etc/bess/edge.toml
)";

constexpr const char* kLogHelp =
    R"(bess-edge log: what was decided in each cycle, and why

  bess-edge log [--config FILE] [--csv] [--last N] [--since UTC]

  --config FILE  the controller's settings; default /etc/bess/edge.toml
  --csv          comma-separated with a header; otherwise one key=value line a cycle
  --last N       only the newest N cycles
  --since UTC    only from this instant on, e.g. 2026-11-21T06:00:00Z

Read from the ring in [state] folder, oldest first, while the controller runs or not.
Exit codes: 0 done   1 the log cannot be read   2 the command line is bad

  bess-edge log --last 10
  bess-edge log --csv --since 2026-11-01T00:00:00Z > november.csv
)";

constexpr const char* kSignatureHelp =
    R"(bess-edge signature: one number for what this build decides

  bess-edge signature

Student and guard replay two recorded days of prices in each month of a year, those of the clock changes
among them, in integers. The signature is over every order: builds with the same student that print
different ones do not decide the same. edge/generated/decision_signature.txt holds the expected line.
Exit codes: 0 done   2 the command line is bad
)";

constexpr const char* kHistoryHelp =
    R"(bess-edge history: which versions and weights this machine has run, and what became of them

  bess-edge history [--json] [--folder FOLDER]

  --json           a list of objects: utc, event, version, student, header_sha256, reason
  --folder FOLDER  where bess-update keeps it; default /var/lib/bess-update

Events: trying (installed, on trial), confirmed, going_back and rolled_back (with the reason), failed (nothing to
go back to). The column "certificate" is the beginning of header_sha256, of the exported header.
Exit codes: 0 done   1 no history   2 the command line is bad

  bess-edge history
  bess-edge history --json | jq '.[-1].event'
)";

constexpr const char* kHoldHelp =
    R"(bess-edge hold: so many watts until an end, whatever the price

  bess-edge hold [--config FILE] WATTS --for DURATION
  bess-edge hold [--config FILE] --release

  WATTS           power to hold: positive charges, negative discharges, 0 rests; up to [battery] power_w
  --for DURATION  how long, 2m to 7d: 90m, 2h, 1d12h
  --release       end the hold before its time
  --config FILE   the controller's settings; default /etc/bess/edge.toml

The running controller follows from its next cycle on, restarts included, and trades again when the end has
passed. A hold stands for the student and the price thresholds, and needs no price. Everything else of the
guard stays stronger: stop reasons, SoC bounds, reserve, cycles, reversals, power and connection limits,
ramp. While the supervision has tripped nothing is driven, and so no hold is followed: that is said, see
bess-edge clear. A new hold replaces the one before. It lies in the [state] folder: run it as the
controller's user, or as root.
Exit codes: 0 done   1 refused: the line says why   2 the command line is bad

  bess-edge hold 0 --for 30m
  bess-edge hold -2000 --for 2h
  bess-edge hold --release
)";

constexpr const char* kLimitHelp =
    R"(bess-edge limit: caps the battery's power for a while, whatever prices and student say

  bess-edge limit [--config FILE] [--charge W] [--discharge W] --for DURATION
  bess-edge limit [--config FILE] --clear

  --config FILE   the controller's settings, with [limits] file; default /etc/bess/edge.toml
  --charge W      no order charges with more; 0 or more; default: any
  --discharge W   no order discharges with more
  --for DURATION  then the limit has lapsed: 90s, 15m, 1h30m, up to 7d
  --clear         takes the limit away

Writes one line, "charge_w discharge_w utc_until", into the file of [limits], in place of the one before; any
program may write it itself, beside and renamed. A running controller looks every few seconds and cuts an order
that is too large at once. After its time the limit is gone, or with on_timeout = "idle" the battery is left at
0 W until a new one comes: then --clear does that too.
Exit codes: 0 done   1 no [limits], or the file cannot be written   2 the command line is bad

  bess-edge limit --charge 0 --for 15m
  bess-edge limit --charge 2000 --discharge 1000 --for 2h
  bess-edge limit --clear
)";

constexpr const char* kRecordHelp =
    R"(bess-edge record: what a battery answers, written to a file; writes nothing to the battery

  bess-edge record --for DURATION [--every DURATION] [--out FILE] [--config FILE]

  --for DURATION    how long, 1s to 7d: 90s, 1h, 1d12h; Ctrl-C ends it before, and the file is whole
  --every DURATION  between two readings of what is measured; default 10s. Everything else that the
                    register map names, and what it would write, is read every 10 minutes
  --out FILE        default: bess-TIME.jsonl in the current folder
  --config FILE     the controller's settings; default /etc/bess/edge.toml

One JSON object a line: request, values or error, latency. Hidden (0, of a text X) is what the map marks as
private, texts beyond what the map's identity check asks for, and every register that the map does not name: the
file can be given away. It holds neither addresses of the network nor prices. Refused while another bess-edge
has the battery: record that one with bess-edge run --record FILE, which has the orders too.
What is made of it: bess-sim battery --replay FILE, and bess-edge map check --against FILE.
Exit codes: 0 recorded   1 the file cannot be written, nobody answered, or the battery is in use
2 the command line is bad

  bess-edge record --for 1h
  bess-edge record --for 5m --every 2s --out inverter.jsonl --config /etc/bess/edge.toml
)";

constexpr const char* kMapCheckHelp =
    R"(bess-edge map check: does a register map fit what a battery answered? Needs no battery

  bess-edge map check --against FILE [--map FILE [--variant NAME] | --config FILE] [--json] [--accept-cut]

  --against FILE  a recording: bess-edge record, or bess-edge run --record
  --map FILE      the register map; default: that of the configuration
  --variant NAME  of the map; default: its first
  --config FILE   the controller's settings; default /etc/bess/edge.toml
  --json          one JSON object
  --accept-cut    take a recording without its last line up to where it was cut

Names every point whose values cannot be true, with what would fit: never answered, outside its range, another
scale, word order or type; a state of charge that stands still or does not follow the measured power; power that
flows against the order. For the last three the battery must have moved energy while it was recorded.
Exit codes: 0 all points are plausible   1 not all, or a file cannot be read   2 the command line is bad

  bess-edge map check --against inverter.jsonl --map edge/maps/sma.toml --variant setpoint
)";

}  // namespace

const char* help_of(SubCommand command) {
  switch (command) {
    case SubCommand::kCommission:
      return kCommissionHelp;
    case SubCommand::kRelease:
      return kReleaseHelp;
    case SubCommand::kClear:
      return kClearHelp;
    case SubCommand::kStatus:
      return kStatusHelp;
    case SubCommand::kLog:
      return kLogHelp;
    case SubCommand::kSignature:
      return kSignatureHelp;
    case SubCommand::kHistory:
      return kHistoryHelp;
    case SubCommand::kHold:
      return kHoldHelp;
    case SubCommand::kLimit:
      return kLimitHelp;
    case SubCommand::kRecord:
      return kRecordHelp;
    case SubCommand::kMapCheck:
      return kMapCheckHelp;
    case SubCommand::kRun:
    case SubCommand::kCheck:
    case SubCommand::kSelfTest:
      break;
  }
  return kRunHelp;
}

}  // namespace bess
