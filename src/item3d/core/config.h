// Typed reading of the small JSON files that lie beside weights (config.json,
// scheduler_config.json, ...).
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// A JSON object with the name of its file, so that every error names file and key. For a missing
/// or null key, the methods return the fallback. For a value of the wrong type or out of range,
/// they throw InputError.
class Config {
  public:
    /// subject: name in messages, usually the path.
    Config(nlohmann::json values, std::string subject);
    static Config read(const std::filesystem::path& path);

    const std::string& subject() const { return subject_; }
    const nlohmann::json& json() const { return values_; }
    /// True if the key exists and is not null.
    bool has(const std::string& key) const;

    /// Returns an integer from -max_integer to max_integer, so that the product of two such
    /// integers cannot overflow 64 bits.
    int integer(const std::string& key, int fallback) const;
    double number(const std::string& key, double fallback) const;
    bool boolean(const std::string& key, bool fallback) const;
    std::string text(const std::string& key, const std::string& fallback) const;
    /// Returns a list of integers. A single integer in the file becomes a list of `count` copies,
    /// or of one copy if `count` is 0.
    std::vector<int> integers(const std::string& key, const std::vector<int>& fallback,
                              std::size_t count = 0) const;
    std::vector<double> numbers(const std::string& key) const;
    std::vector<std::string> texts(const std::string& key,
                                   const std::vector<std::string>& fallback) const;

    /// Returns the object under a key. Throws InputError when there is none.
    Config part(const std::string& key) const;

    /// Returns integer(). Throws InputError if it is below one.
    int size(const std::string& key, int fallback) const;
    std::vector<int> sizes(const std::string& key, const std::vector<int>& fallback,
                           std::size_t count = 0) const;

    /// Throws InputError if the key has a value other than `value`. Used for options that have one
    /// value in all supported models.
    void expect(const std::string& key, const nlohmann::json& value) const;
    [[noreturn]] void fail(const std::string& key, const std::string& wanted) const;
    /// Throws InputError "KEY: PROBLEM".
    [[noreturn]] void reject(const std::string& key, const std::string& problem) const;

    static constexpr int max_integer = 1 << 24;

  private:
    nlohmann::json values_;
    std::string subject_;
};

}  // namespace item3d
