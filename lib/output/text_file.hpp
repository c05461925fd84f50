// Small text files written so that a reader, or the next run after a crash, never meets half of one. Serial.
#pragma once

#include <string>

namespace amontons {

/// Replaces the file at `path` by `text`: a temporary file beside it, synchronized, then renamed. Throws UserError when
/// the disk or the permissions do not allow it; the old file is then still there. Call on rank 0 (inside on_root).
void write_atomically(const std::string& path, const std::string& text);

/// The whole file. Throws UserError when it cannot be read; `what` names it in the message ("the history").
std::string read_text(const std::string& path, const std::string& what);

/// Gives the finished file `from` the name `to`, after its contents have reached the disk. Throws UserError.
void rename_synchronized(const std::string& from, const std::string& to);

} // namespace amontons
