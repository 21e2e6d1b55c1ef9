// Files that are being written under a temporary name: a signal that ends the program takes them
// along.
#pragma once

#include <string>

namespace bess {

/// Names one such file, from before it is made until it is complete or gone. Of many at once, some
/// are not remembered: the next writer of the same name finds those.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::string& path);
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();
  /// Once the file is made: when the program is ending already, removes it and never returns.
  void made() const;

 private:
  int slot_ = -1;
  std::string path_;
};

/// Removes all of them, and whoever makes another waits for the end. For a signal's handler that
/// ends the program: calls nothing that such a handler may not.
void remove_unfinished_files();

}  // namespace bess
