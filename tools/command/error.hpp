#pragma once

#include <stdexcept>
#include <string>

namespace odoless {

/// A failure that the user can mend. Its text says what is wrong, where, and what would be right; `exit_code` is one of
/// sysexits.h. Thrown anywhere in tools, caught once in main.
class UserError : public std::runtime_error {
 public:
  UserError(int exit_code, const std::string& message, int error_number = 0)
      : std::runtime_error(message), exit_code_(exit_code), error_number_(error_number) {}

  [[nodiscard]] int exit_code() const { return exit_code_; }
  /// errno of the call that failed; 0: it was none.
  [[nodiscard]] int error_number() const { return error_number_; }

 private:
  int exit_code_;
  int error_number_;
};

/// Options or arguments that make no sense together: exit 64.
class UsageError : public UserError {
 public:
  explicit UsageError(const std::string& message) : UserError(64, message) {}
};

/// A file that can be read but is not what it should be: exit 65.
class DataError : public UserError {
 public:
  /// @param line   Counted from 1; 0 when the file as a whole is meant.
  /// @param wrong  What is there.
  /// @param right  What should be there.
  DataError(const std::string& file, int line, const std::string& wrong, const std::string& right);
};

/// A file that is missing or cannot be opened for reading: exit 66.
class NoInputError : public UserError {
 public:
  explicit NoInputError(const std::string& message) : UserError(66, message) {}
};

/// An output that cannot be created: exit 73.
class CannotCreateError : public UserError {
 public:
  explicit CannotCreateError(const std::string& message, int error_number = 0) : UserError(73, message, error_number) {}
};

/// A read or write that failed half-way: exit 74.
class IoError : public UserError {
 public:
  explicit IoError(const std::string& message, int error_number = 0) : UserError(74, message, error_number) {}
};

/// What the system says of an error number.
[[nodiscard]] std::string system_reason(int error_number);

}  // namespace odoless
