// What every function of the library throws.
#pragma once

#include <stdexcept>
#include <string>

#include <wavepath/export.h>

namespace wavepath_v0 {

// what() is "WHERE: PROBLEM; REMEDY", as the command line prints it.
class WAVEPATH_API Error : public std::runtime_error {
public:
  Error(const std::string& where, const std::string& problem, const std::string& remedy);
  ~Error() override;

  const std::string& where() const { return where_; }     // the file, setting or device it is about
  const std::string& problem() const { return problem_; } // what is wrong with it
  const std::string& remedy() const { return remedy_; }   // what the caller can do

private:
  std::string where_, problem_, remedy_;
};

// Settings or arguments that make no sense, where the command line would exit with 2.
class WAVEPATH_API UsageError : public Error {
public:
  using Error::Error;
  ~UsageError() override;
};

} // namespace wavepath_v0
