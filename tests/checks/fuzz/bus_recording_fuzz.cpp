// Device recordings: refused with one line that names file and line, or read to the end.
#include "shared/host/bus_recording.h"
#include "tests/checks/fuzz/fuzz_target.h"
#include "tests/checks/fuzz/scratch_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  using Next = BusRecordingReader::Next;
  static const ScratchFile file("device.jsonl");
  const std::string path = file.holding(text_of(data, size));
  for (const CutRecording cut : {CutRecording::kRefused, CutRecording::kAccepted}) {
    BusRecordingReader reader;
    std::string error;
    if (!reader.open(path, cut, error)) {
      must(error.starts_with(path + ":1: "), "a head is refused with its place");
      continue;
    }
    BusExchange exchange;
    Next next = reader.next(exchange, error);
    std::int64_t exchanges = 0;
    for (; next == Next::kExchange; next = reader.next(exchange, error)) {
      ++exchanges;
      must(exchange.count >= 1 && exchange.count <= BusExchange::kRegistersMax, "registers fit");
      must(exchange.values().size() <= exchange.count, "as many values as registers");
    }
    must((next == Next::kDamaged) == error.starts_with(path + ":"),
         "damage is reported with its place");
    must(error.find('\n') == std::string::npos, "one line");
    must(exchanges == reader.exchanges(), "every exchange is counted");
  }
  return 0;
}
