// Asks about the later samples of the pattern that a dart covers which has become a sample.
// import: near

var<private> dart: Dart;

fn visit(other: u32, moved: vec2<i32>) -> bool {
    let sample = darts[other];
    if !is_own(sample) || !covers_offset(at(sample) + moved - at(dart)) || !is_before(dart, sample) {
        return false;
    }

    let before = atomicOr(&states[other], DART_QUESTION);
    // A sample of a later throw is listed when its throw begins.
    if (before & DART_QUESTION) == 0u && throw_of(sample) == throw_of(dart) {
        questions[atomicAdd(&counters[COUNTER_QUESTIONS], 1u)] = other;
    }
    return false;
}

fn run(index: u32) {
    if index >= atomicLoad(&counters[COUNTER_JUDGED]) {
        return;
    }

    let asked = questions[index];
    let was_present = (atomicLoad(&states[asked]) & DART_PRESENT) != 0u;
    dart = darts[asked];
    // Samples of the pattern cover no other ones of their block, and those at borders are questions from the beginning.
    if !was_present && verdicts[index] != 0u && !is_own(dart) {
        any_near(at(dart) - R, at(dart) + R);
    }
}
