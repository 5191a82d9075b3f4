// Answers each question of a throw from the samples as they are: whether no earlier sample covers the dart.
// import: near

var<private> judged: u32;
var<private> dart: Dart;

fn visit(other: u32, moved: vec2<i32>) -> bool {
    if other == judged || (states[other] & DART_PRESENT) == 0u {
        return false;
    }
    let sample = darts[other];
    if !covers_offset(at(sample) + moved - at(dart)) {
        return false;
    }
    // Of two darts that are equal in all, either one may stay, and the set is the same.
    return is_before(sample, dart) || (!is_before(dart, sample) && other < judged);
}

fn run(index: u32) {
    if index >= counters[COUNTER_JUDGED] {
        return;
    }
    judged = questions[index];
    dart = darts[judged];
    verdicts[index] = select(1u, 0u, any_near(at(dart) - R, at(dart) + R));
}
