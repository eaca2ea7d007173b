// Tokenizer interface of the captioning networks.
#pragma once

#include <string>
#include <vector>

namespace item3d {

class CaptionTokenizer {
  public:
    virtual ~CaptionTokenizer() = default;
    /// Returns the ids of `text` (UTF-8), with the special tokens that begin and end the network's
    /// prompts.
    virtual std::vector<int> encode(const std::string& text) const = 0;
    /// Returns the text of `ids`, without special tokens.
    virtual std::string decode(const std::vector<int>& ids) const = 0;
    virtual int largest_id() const = 0;
};

}  // namespace item3d
