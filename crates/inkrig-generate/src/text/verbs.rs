//! The action verbs that the model knows.

/// An action and the words for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Verb {
    /// The verb as it is shown, and as it names its row.
    pub name: &'static str,
    /// Other words for it, and phrases of up to three words, in their plain form: endings (-s, -ing, -ed) are found by
    /// [`actions_in`](super::actions_in).
    pub words: &'static [&'static str],
}

/// All of them. A row of a model's table belongs to a place in this list, so new ones are put at its end.
pub const VERBS: &[Verb] = &[
    verb("walk", &["stroll", "pace", "wander", "go", "stride", "amble"]),
    verb("run", &["sprint", "dash", "running", "rush"]),
    verb("jog", &["trot"]),
    verb("jump", &["hop", "leap", "bounce", "vault", "jete", "jumping jack", "jump jack"]),
    verb("skip", &[]),
    verb(
        "kick",
        &[
            "roundhouse",
            "sidekick",
            "side kick",
            "spinkick",
            "crescent",
            "cresent",
            "front kick",
            "axe kick",
            "mawashigeri",
            "yokogeri",
        ],
    ),
    verb(
        "punch",
        &[
            "boxing",
            "jab",
            "hook",
            "uppercut",
            "backfist",
            "cross left",
            "cross right",
            "oiduki",
            "strike",
            "hit",
        ],
    ),
    verb("throw", &["pitch", "toss", "hurl", "lob", "fling"]),
    verb("catch", &[]),
    verb("wave", &["greet", "greeting", "hello", "bye", "byebye", "beckon"]),
    verb("point", &["direct traffic", "signal"]),
    verb(
        "dance",
        &[
            "salsa",
            "indian dance",
            "ballet",
            "arabesque",
            "attitude",
            "glissade",
            "capoeira",
            "capoera",
            "waltz",
        ],
    ),
    verb("climb", &["ladder", "stepstool", "clamber"]),
    verb("sit down", &["sit", "seat"]),
    verb("stand up", &["get up", "getup", "rise", "arise", "awaken"]),
    verb("lie down", &["lie", "lay down"]),
    verb("crawl", &["creep", "all fours"]),
    verb("crouch", &["duck", "squat", "kneel", "curl"]),
    verb("bend", &["bow", "lean", "stoop"]),
    verb("pick up", &["pickup", "lift", "grab", "scoop"]),
    verb("put down", &["set down", "lay aside"]),
    verb("turn", &["veer", "turning", "look around"]),
    verb("spin", &["twirl", "pirouette", "whirl", "rotate", "tourant"]),
    verb("cartwheel", &["cart wheel"]),
    verb(
        "flip",
        &["backflip", "sideflip", "somersault", "handspring", "hand spring", "acrobatics", "acrobatic"],
    ),
    verb("roll", &["tumble"]),
    verb("balance", &[]),
    verb("stretch", &["reach", "yawn"]),
    verb("swing", &["sway", "dangle"]),
    verb("sneak", &["tiptoe", "stealthy", "stealthily", "prowl"]),
    verb("march", &["parade", "stomp"]),
    verb("limp", &["stagger", "stumble", "zombie", "hobble"]),
    verb("dribble", &["basketball"]),
    verb("shoot", &["aim"]),
    verb("slash", &["sword", "swordplay", "chop", "slice", "stab", "attack"]),
    verb("block", &["parry", "syutouuke", "guard", "defend"]),
    verb("dodge", &["evade", "side step", "sidestep", "strafe"]),
    verb("push", &["shove"]),
    verb("pull", &["drag", "tug"]),
    verb("carry", &["hold", "with box"]),
    verb("drink", &["sip"]),
    verb("eat", &["chew", "bite"]),
    verb("wash", &["mop", "sweep", "wipe", "clean", "scrub"]),
    verb("laugh", &["giggle"]),
    verb("talk", &["conversation", "speak", "chat", "gesture", "tell", "respond", "call"]),
    verb("clap", &["applaud"]),
    verb("cheer", &["celebrate", "taunt"]),
    verb("exercise", &["push up", "pushup", "sit up", "situp", "twist", "warm up", "range of motion"]),
    verb("karate", &["martial art", "empi", "heian", "heiansyodan", "gedanbarai", "kata"]),
    verb("fall", &["die", "death", "collapse"]),
    verb("dive", &["swim"]),
    verb("hang", &["cling"]),
    verb("stand", &["idle", "wait", "static pose", "still"]),
    verb("step", &["pace back"]),
];

const fn verb(name: &'static str, words: &'static [&'static str]) -> Verb {
    Verb { name, words }
}
