//! Kinds of events: their names in queries and their depths in the tree of events.

macro_rules! kinds {
    ($($kind:ident $name:literal $depth:literal $doc:literal,)*) => {
        /// The kind of an event. Depths: 0 phase or iteration, 1 block, 2 sample, 3 search, 4 test.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        #[repr(u8)]
        pub enum EventKind { $(#[doc = $doc] #[serde(rename = $name)] $kind,)* }

        impl EventKind {
            /// All kinds, in the order of their numbers.
            pub const ALL: &[Self] = &[$(Self::$kind,)*];

            /// Returns the name that queries use.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$kind => $name,)* }
            }

            /// Returns what happens, as a sentence.
            #[must_use]
            pub const fn explanation(self) -> &'static str {
                match self { $(Self::$kind => $doc,)* }
            }

            /// Returns the kind of a name.
            #[must_use]
            pub fn named(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|kind| kind.name() == name)
            }

            /// Returns the depth in the tree of events, from 0.
            #[must_use]
            pub const fn depth(self) -> u8 {
                match self { $(Self::$kind => $depth,)* }
            }
        }
    };
}

kinds! {
    Begin "begin" 0 "A phase begins.",
    Split "split" 1 "A node of the KD-tree is cut.",
    Leaf "leaf" 1 "A node of the KD-tree is a block.",
    Clip "clip" 1 "A block's clip is placed.",
    Tiled "tiled" 2 "A sample is tiled.",
    Take "take" 2 "Elimination takes a sample.",
    Keep "keep" 3 "A sample is kept.",
    Test "test" 4 "Two samples are compared.",
    Eliminate "eliminate" 4 "A sample is eliminated.",
    Mark "mark" 3 "A sample becomes a detector.",
    Iteration "iteration" 0 "An iteration begins.",
    Detect "detect" 2 "A detector begins.",
    Search "search" 3 "A test buffer is gathered.",
    NoGap "no-gap" 3 "A detector's neighbours leave no gap.",
    Call "call" 3 "Algorithm 3 is called.",
    Pairs "pairs" 3 "Pairs of the test buffer follow.",
    Candidate "candidate" 4 "A place is examined.",
    Rank "rank" 2 "Candidates are put in order.",
    Pass "pass" 4 "A candidate is passed over.",
    Insert "insert" 4 "A sample is inserted.",
    Wake "wake" 4 "A refused dart is to be asked again.",
    Dart "dart" 4 "A dart is thrown.",
    Cut "cut" 4 "An active cell is cut in four, a cube in eight.",
    IterationEnd "iteration-end" 1 "An iteration ends.",
    Finish "finish" 1 "The result is there.",
    Thinned "thinned" 4 "Tests were left out here to stay within the budget.",
}
