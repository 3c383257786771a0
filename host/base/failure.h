// Failures of any kind: what they tell the user, and steps that are all tried whichever of them fail.
#pragma once

#include <exception>
#include <string>

namespace wavepath {

// The line of an Error (file, problem, remedy), and one of the same form for a lack of memory or threads.
std::string failure_text(const std::exception& failure);

// Steps of which each is tried, whatever became of those before: one output that fails does not cost the others.
class Attempts {
public:
  // Returns false if it failed.
  template <class Step>
  bool attempt(const Step& step) {
    try {
      step();
      return true;
    } catch (const std::exception& failure) {
      note(failure);
      return false;
    }
  }
  // Throws the first failure, if there was any, and tells the others as warnings.
  void finish();

private:
  void note(const std::exception& failure); // notes the exception that the calling handler has caught

  std::exception_ptr first_;
  bool only_reader_gone_ = false; // any other failure replaces it
  std::string others_;            // lines
};

} // namespace wavepath
