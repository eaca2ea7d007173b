// Tokenizer interface of the captioning networks.
#pragma once

#include <string>
#include <vector>

namespace item3d {

class CaptionTokenizer {
  public:
    virtual ~CaptionTokenizer() = default;
    /// Returns ids with the special tokens at the beginning and end of the network's prompts. text:
    /// UTF-8.
    virtual std::vector<int> encode(const std::string& text) const = 0;
    /// Returns text without special tokens.
    virtual std::string decode(const std::vector<int>& ids) const = 0;
    virtual int largest_id() const = 0;
};

}  // namespace item3d
