#include "edge/fetch/price_publisher.h"

#include <cerrno>
#include <cstring>
#include <vector>

#include "edge/log/journal.h"
#include "edge/log/whole_file.h"
#include "shared/scaled_clock.h"

namespace bess {

void PricePublisher::publish_outlook(OutlookBoard& board) {
  const std::lock_guard lock(mutex_);
  if (outlook_ == nullptr) outlook_ = std::make_unique<PublishedOutlook>();
  outlook_->offer = board.offers.latest();
  outlook_->usual = board.usual;
  ++prices_.outlook_number;
  write();
}

void PricePublisher::write() {
  prices_.written_monotonic_ns = clock_ns(CLOCK_MONOTONIC);
  std::vector<char> file(kPublishedBytesMax);
  const std::size_t size = encode_published(prices_, outlook_.get(), file);
  const bool is_written = replace_file(path_.c_str(), {file.data(), size});
  if (is_written == is_failing_) {
    write_journal_line(
        is_written ? JournalLevel::kNotice : JournalLevel::kError,
        "bess-prices: " + path_ +
            (is_written ? " is written again"
                        : std::string(" cannot be written: ") + std::strerror(errno)));
  }
  is_failing_ = !is_written;
}

}  // namespace bess
