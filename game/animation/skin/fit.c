// The reference's pose on a body of other proportions; see game/animation/fitting.py for what is wanted of it.
#include "fit.h"

// 0 at nought, 1 at one, smooth between.
static float smooth(float x) {
    x = clamp(x, 0, 1);
    return x * x * (3 - 2 * x);
}

static float near(Limit limit, float x) { return smooth((x - limit.none) / (limit.full - limit.none)); }

static Vec3 times(Vec3 a, Vec3 b) { return vec3(a.x * b.x, a.y * b.y, a.z * b.z); }

static Vec3 over(Vec3 a, Vec3 b) { return vec3(a.x / b.x, a.y / b.y, a.z / b.z); }

// Where something is in a region of a body, in its radii.
static Vec3 into(const Region *region, const Rigid *joint, Vec3 place) {
    return over(sub(rotate(conjugate(joint->turn), sub(place, joint->place)), region->centre), region->radius);
}

static Vec3 out_of(const Region *region, const Rigid *joint, Vec3 local) {
    return point_from(joint, add(times(local, region->radius), region->centre));
}

// How much a palm belongs to the table.
static float on_table(const Fit *fit, Vec3 palm) {
    float high = near(fit->high_back, palm.z), low = near(fit->low_back, palm.z);
    float share = high + near(fit->low, palm.y) * (low - high);
    return share * near(fit->beside_table, palm.z) * near(fit->above_table, palm.y);
}

// Where a palm of the reference's is on this body.
static Vec3 fitted_palm(const Fit *fit, int side, const Rigid *reference, const Rigid *mine, Vec3 palm) {
    Vec3 local[REGIONS];
    float table = on_table(fit, palm), open = 1 - table, sum = table;
    // Over the table: the same place in the world, at the height of this hand.
    Vec3 found = scale(vec3(palm.x, fit->table_m + (palm.y - fit->table_m) * fit->hand, palm.z), table);
    for (int i = 0; i < REGIONS; i++) {
        const BodyPart *part = &fit->part[i];
        local[i] = into(&part->reference, &reference[part->joint], palm);
        // The table does not give way, so it comes before the body behind it.
        float weight = near(fit->beside_body, length(local[i])) * (1 - table);
        found = add(found, scale(out_of(&part->mine, &mine[part->joint], local[i]), weight));
        open *= 1 - weight;
        sum += weight;
    }
    // What no contact claims is in the open, as seen from the shoulder.
    int upper = fit->limb[side].upper;
    Vec3 far = scale(sub(palm, reference[upper].place), fit->arm[side]);
    found = scale(add(found, scale(add(mine[upper].place, far), open)), 1 / (sum + open));

    // Between two places, and on the way to one, a palm is no deeper in this trunk than in the reference's.
    float most_lacking = 0;
    Vec3 push = {0, 0, 0};
    for (int i = 0; i < TRUNK; i++) {
        const BodyPart *part = &fit->part[i];
        Vec3 inside = into(&part->mine, &mine[part->joint], found);
        float wanted = least(length(local[i]), fit->clear);
        float lacking = wanted > fit->middle ? wanted / most(length(inside), 1e-3f) - 1 : 0;
        if (lacking > most_lacking) {
            most_lacking = lacking;
            push = rotate(mine[part->joint].turn, times(scale(inside, lacking), part->mine.radius));
        }
    }
    return add(found, push);
}

void fit_pose(const Fit *fit, Quat *turn, Vec3 *root) {
    Rigid reference[FIGURE], mine[FIGURE];
    // Trunk, head and fingers keep their rotations.
    for (int i = 0; i < FIGURE; i++) {
        const FigureJoint *joint = &fit->joint[i];
        if (joint->parent < 0) {
            reference[i] = (Rigid){turn[joint->turn], *root};
            *root = add(fit->hips, scale(sub(*root, fit->hips_reference), fit->leg));
            mine[i] = (Rigid){turn[joint->turn], *root};
        } else {
            reference[i] = carried(&reference[joint->parent], turn[joint->turn], joint->reference);
            mine[i] = (Rigid){reference[i].turn, point_from(&mine[joint->parent], joint->mine)};
        }
    }

    // Palms: what touches, seen from the wrist.
    Vec3 reach[2], palm[2], found[2];
    for (int side = 0; side < 2; side++) {
        const Rigid *hand = &reference[fit->limb[side].end];
        reach[side] = rotate(hand->turn, fit->palm[side]);
        palm[side] = add(hand->place, reach[side]);
        found[side] = fitted_palm(fit, side, reference, mine, palm[side]);
    }
    // Hands that hold each other.
    Vec3 way = sub(palm[1], palm[0]);
    Vec3 lack = sub(scale(way, fit->hand), sub(found[1], found[0]));
    Vec3 fix = scale(lack, 0.5f * near(fit->together, length(way)));
    found[0] = sub(found[0], fix);
    found[1] = add(found[1], fix);

    // Bigger hands reach deeper where the same palm touches.
    for (int side = 0; side < 2 && fit->shapes; side++) {
        Vec3 wrist = sub(found[side], scale(reach[side], fit->hand));
        Quat hand = reference[fit->limb[side].end].turn;
        Vec3 push = clear_of_body(fit, side, mine, wrist, hand, turn);
        // Not into the table.
        if (push.y < 0) push.y *= 1 - on_table(fit, palm[side]);
        found[side] = add(found[side], push);
    }

    for (int i = 0; i < LIMBS; i++) {
        const FigureLimb *limb = &fit->limb[i];
        Rigid goal = reference[limb->end];
        if (i < 2)
            goal.place = sub(found[i], scale(reach[i], fit->hand));
        else
            goal.place = add(limb->foot, scale(sub(goal.place, limb->foot_reference), fit->leg));
        Quat local[3];
        place_limb(&limb->bones, mine[limb->above].turn, &mine[limb->upper], &mine[limb->lower], &mine[limb->end],
                   &goal, local);
        turn[fit->joint[limb->upper].turn] = local[0];
        turn[fit->joint[limb->lower].turn] = local[1];
        turn[fit->joint[limb->end].turn] = local[2];
    }
}
