"""Makes crates/inkrig-generate/tests/fixtures/text: small encoders with random weights and tokenizers trained on a few
sentences of ours, with what `transformers` and `tokenizers` make of them.

    pip install torch transformers tokenizers safetensors
    python benches/peers/text_fixtures.py
"""
import json
import pathlib

import torch
from safetensors.torch import save_file
from tokenizers import Tokenizer, decoders, models, normalizers, pre_tokenizers, processors, trainers
from transformers import CLIPTextConfig, CLIPTextModelWithProjection, T5Config, T5EncoderModel

OUT = pathlib.Path(__file__).parents[2] / "crates/inkrig-generate/tests/fixtures/text"
SENTENCES = [
    "a person kicks.", "a person is kicking high, then walks away.", "someone jumps over the box", "He's dancing & it's fun!",
    "a man walks forwards slowly and sits down", "she throws the ball 12 times", "  two   spaces  ", "zebra quiz jinx", "",
]


def randomise(model):
    torch.manual_seed(7)
    with torch.no_grad():
        for name, tensor in model.named_parameters():
            scale = 0.5 if "embed" in name or "shared" in name or "bias" in name else tensor.shape[-1] ** -0.5
            tensor.copy_(torch.randn_like(tensor) * scale + (1.0 if "norm" in name and name.endswith("weight") else 0.0))


def ids(vocabulary, length, end):
    return torch.cat([torch.randint(3, vocabulary, (length - 1,)), torch.tensor([end])])[None]


def save(name, weights, config, cases):
    weights = {key: value.contiguous().clone() for key, value in weights.items()}
    for at, (tokens, vector) in enumerate(cases):
        weights[f"case.{at}.tokens"] = tokens[0].float()
        weights[f"case.{at}.vector"] = vector[0].clone()
    save_file(weights, OUT / f"{name}.safetensors", {"config": json.dumps(config)})


def t5(name, feed_forward):
    config = T5Config(vocab_size=40, d_model=24, d_kv=8, d_ff=40, num_layers=3, num_heads=2, feed_forward_proj=feed_forward,
                      relative_attention_num_buckets=8, relative_attention_max_distance=16)
    model = T5EncoderModel(config).eval()
    randomise(model)
    dense = torch.nn.Linear(24, 16, bias=False)
    cases = []
    with torch.no_grad():
        for length in (1, 5, 30):
            tokens = ids(40, length, 1)
            pooled = model(tokens).last_hidden_state.mean(1)
            cases.append((tokens, torch.nn.functional.normalize(dense(pooled), dim=-1)))
    weights = {key: value for key, value in model.state_dict().items() if key != "encoder.embed_tokens.weight"}
    weights["linear.weight"] = dense.weight.detach()
    save(name, weights, config.to_dict(), cases)


def clip():
    config = CLIPTextConfig(vocab_size=40, hidden_size=24, intermediate_size=48, projection_dim=16, num_hidden_layers=3,
                            num_attention_heads=2, max_position_embeddings=20, eos_token_id=39, bos_token_id=38)
    model = CLIPTextModelWithProjection(config).eval()
    randomise(model)
    cases = []
    with torch.no_grad():
        for length in (1, 5, 19):
            tokens = torch.cat([torch.tensor([[38]]), ids(38, length, 39)], 1)
            # Padding after the end, as the published code has it, changes nothing.
            padded = torch.nn.functional.pad(tokens, (0, 20 - tokens.shape[1]), value=39)
            cases.append((tokens, model(padded).text_embeds))
    weights = {key: value for key, value in model.state_dict().items() if "position_ids" not in key}
    save("clip", weights, config.to_dict(), cases)


def tokenizers():
    unigram = Tokenizer(models.Unigram())
    unigram.normalizer = normalizers.Sequence([normalizers.NFKC(), normalizers.Replace(__import__("tokenizers").Regex(" {2,}"), " ")])
    unigram.pre_tokenizer = pre_tokenizers.Metaspace(prepend_scheme="always")
    unigram.decoder = decoders.Metaspace()
    special = ["<pad>", "</s>", "<unk>"]
    unigram.train_from_iterator(SENTENCES, trainers.UnigramTrainer(vocab_size=120, special_tokens=special, unk_token="<unk>"))
    unigram.post_processor = processors.TemplateProcessing(single="$A </s>", special_tokens=[("</s>", 1)])
    unigram.save(str(OUT / "unigram.json"), pretty=False)

    bpe = Tokenizer(models.BPE(unk_token="<|endoftext|>", end_of_word_suffix="</w>", fuse_unk=False))
    bpe.normalizer = normalizers.Sequence([normalizers.NFC(), normalizers.Replace(__import__("tokenizers").Regex(r"\s+"), " "), normalizers.Lowercase()])
    pattern = r"'s|'t|'re|'ve|'m|'ll|'d|[\p{L}]+|[\p{N}]|[^\s\p{L}\p{N}]+"
    bpe.pre_tokenizer = pre_tokenizers.Sequence([
        pre_tokenizers.Split(__import__("tokenizers").Regex(pattern), "removed", invert=True),
        pre_tokenizers.ByteLevel(add_prefix_space=False, use_regex=False),
    ])
    trainer = trainers.BpeTrainer(vocab_size=700, initial_alphabet=pre_tokenizers.ByteLevel.alphabet(), end_of_word_suffix="</w>",
                                  special_tokens=["<|startoftext|>", "<|endoftext|>"])
    bpe.train_from_iterator(SENTENCES, trainer)
    start, end = bpe.token_to_id("<|startoftext|>"), bpe.token_to_id("<|endoftext|>")
    bpe.post_processor = processors.TemplateProcessing(
        single="<|startoftext|> $A <|endoftext|>", special_tokens=[("<|startoftext|>", start), ("<|endoftext|>", end)])
    bpe.save(str(OUT / "bpe.json"), pretty=False)
    extra = ["kick the box, he's 42", "unknown words: xylophone", "Größe café"]
    cases = {name: [[text, tokenizer.encode(text).ids] for text in SENTENCES + extra]
             for name, tokenizer in (("unigram", unigram), ("bpe", bpe))}
    (OUT / "tokens.json").write_text(json.dumps(cases, ensure_ascii=False))


OUT.mkdir(parents=True, exist_ok=True)
t5("t5", "relu")
t5("t5_gated", "gated-gelu")
clip()
tokenizers()
