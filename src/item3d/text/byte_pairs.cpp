#include "item3d/text/byte_pairs.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/text/normalization.h"
#include "item3d/text/tokenizer_json.h"

#include <algorithm>
#include <queue>
#include <sstream>

namespace item3d {
namespace {

std::uint64_t pair_key(int left, int right) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(left)) << 32 |
           static_cast<std::uint32_t>(right);
}

BytePairs::Merges read_merges(const std::filesystem::path& path) {
    BytePairs::Merges merges;
    std::istringstream lines(read_text(path));
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.empty() || line.starts_with("#version")) continue;
        const std::size_t space = line.find(' ');
        if (space == std::string::npos || space == 0 || space + 1 == line.size() ||
            line.find(' ', space + 1) != std::string::npos)
            throw InputError(
                path.string(),
                fmt::format("line {}: expected two symbols with a space between them", number),
                "download the tokenizer again");
        merges.emplace_back(line.substr(0, space), line.substr(space + 1));
    }
    return merges;
}

}  // namespace

BytePairs::BytePairs(Vocabulary vocabulary, Merges merges, std::string word_end,
                     const std::string& subject)
    : word_end_(std::move(word_end)),
      id_of_(std::move(vocabulary)),
      merge_list_(std::move(merges)) {
    for (const auto& [token, id] : id_of_) {
        if (!token_of_.emplace(id, token).second)
            throw InputError(subject, fmt::format("two tokens have id {}", id),
                             "download the tokenizer again");
        largest_id_ = std::max(largest_id_, id);
    }
    const auto need = [&](const std::string& token) {
        const auto found = id_of_.find(token);
        if (found == id_of_.end())
            throw InputError(subject, fmt::format("token '{}' is missing", token),
                             "download the tokenizer again");
        return found->second;
    };
    for (std::size_t rank = 0; rank < merge_list_.size(); ++rank) {
        const auto& [left, right] = merge_list_[rank];
        merges_.try_emplace(pair_key(need(left), need(right)),
                            Merge{static_cast<std::int64_t>(rank), need(left + right)});
    }
}

BytePairs BytePairs::load(const std::filesystem::path& folder, const std::string& word_end) {
    const auto ids = [](const std::vector<std::pair<std::string, int>>& tokens) {
        return Vocabulary(tokens.begin(), tokens.end());
    };
    if (const auto file = TokenizerJson::read(folder, "vocab.json", "BPE"))
        return BytePairs(ids(file->vocabulary()), file->merges(), word_end, file->subject());
    const std::filesystem::path path = folder / "vocab.json";
    Vocabulary vocabulary = ids(read_ids(Config::read(path)));
    return BytePairs(std::move(vocabulary), read_merges(folder / "merges.txt"), word_end,
                     path.string());
}

void BytePairs::save(const std::filesystem::path& folder) const {
    std::vector<std::pair<int, std::string>> tokens(token_of_.begin(), token_of_.end());
    std::sort(tokens.begin(), tokens.end());
    nlohmann::ordered_json vocabulary = nlohmann::ordered_json::object();
    for (const auto& [id, token] : tokens)
        vocabulary[token] = id;
    write_atomically(folder / "vocab.json", vocabulary.dump());

    std::string merges = "#version: 0.2\n";
    for (const auto& [left, right] : merge_list_)
        merges += left + " " + right + "\n";
    write_atomically(folder / "merges.txt", merges);
}

void BytePairs::append_word(const std::string& bytes, int unknown, std::vector<int>& ids) const {
    // A doubly linked list of symbols and a priority queue of possible merges take O(n log n) in
    // the word's length n. An attacker's prompt may contain very long words.
    struct Symbol {
        int id;
        int previous, next;
        bool gone = false;
    };
    struct Candidate {
        std::int64_t rank;
        int at, id;
        bool operator<(const Candidate& other) const {  // the queue's top is its largest element
            return std::pair(rank, at) > std::pair(other.rank, other.at);
        }
    };
    std::vector<Symbol> symbols;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string symbol = byte_symbols()[static_cast<std::uint8_t>(bytes[i])];
        if (i + 1 == bytes.size()) symbol += word_end_;
        const auto found = id_of_.find(symbol);
        const int at = static_cast<int>(i);
        symbols.push_back({found == id_of_.end() ? unknown : found->second, at - 1,
                           i + 1 == bytes.size() ? -1 : at + 1});
    }

    const auto merge_at = [&](int at) -> const Merge* {
        if (at < 0 || symbols[at].next < 0) return nullptr;
        const auto found = merges_.find(pair_key(symbols[at].id, symbols[symbols[at].next].id));
        return found == merges_.end() ? nullptr : &found->second;
    };
    std::priority_queue<Candidate> queue;
    const auto consider = [&](int at) {
        if (const Merge* merge = merge_at(at)) queue.push({merge->rank, at, merge->id});
    };
    for (int i = 0; i < static_cast<int>(symbols.size()); ++i)
        consider(i);
    while (!queue.empty()) {
        const Candidate top = queue.top();
        queue.pop();
        if (symbols[top.at].gone) continue;
        const Merge* merge = merge_at(top.at);
        if (!merge || merge->id != top.id) continue;  // a neighbour was merged since
        Symbol& left = symbols[top.at];
        Symbol& right = symbols[left.next];
        left.id = merge->id;
        left.next = right.next;
        if (right.next >= 0) symbols[right.next].previous = top.at;
        right.gone = true;
        consider(left.previous);
        consider(top.at);
    }
    for (const Symbol& symbol : symbols)
        if (!symbol.gone) ids.push_back(symbol.id);
}

int BytePairs::add_token(const std::string& token) {
    ++largest_id_;
    id_of_[token] = largest_id_;
    token_of_[largest_id_] = token;
    return largest_id_;
}

int BytePairs::id_of(const std::string& token) const {
    const auto found = id_of_.find(token);
    return found == id_of_.end() ? -1 : found->second;
}

const std::string* BytePairs::token_of(int id) const {
    const auto found = token_of_.find(id);
    return found == token_of_.end() ? nullptr : &found->second;
}

}  // namespace item3d
