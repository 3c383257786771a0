// Outputs of a command must replace neither its inputs nor each other, whatever names these files have.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace wavepath {

// The path at which a file of this name is, or would be made: links are followed, also those that lead to nothing yet.
std::filesystem::path target_of(const std::string& name);

// Throws UsageError where an output is the file of an input, of another output, or of stdout or stderr: the same device
// and inode, or for files that are yet to be made, the same path, without regard to case where the folder has none.
// Devices and pipes are not replaced, and an output that is named by its descriptor (/dev/stdout) is meant to be one.
// Inputs that are no files, such as empty names, are passed over.
void refuse_overwriting(std::span<const std::string> outputs, std::span<const std::string> inputs);

} // namespace wavepath
