// What the registration classes of this library have in common: they stand in for
// pcl::IterativeClosestPoint, may be derived from, and deal with points, indices and
// guesses that PCL's class would abort on.
#include "support/registration_support.h"

#include <pcl/registration/incremental_registration.h>
#include <pcl/registration/stochastic_gradient_icp.h>

#include <limits>
#include <memory>
#include <new>
#include <stdexcept>

namespace pcl::test {
namespace {

struct CalibratedIcp : BayesianIcp {
  CalibratedIcp() { useFewSamples(*this); }
};
struct PaperIcp : BayesianIcp {
  PaperIcp() { usePaper(*this); }
};
using SgdIcp = StochasticGradientDescentIterativeClosestPoint<PointXYZ, PointXYZ>;

void
expectSameResult(BayesianIcp& actual, BayesianIcp& expected)
{
  EXPECT_EQ(actual.getFinalTransformation(), expected.getFinalTransformation());
  EXPECT_EQ(actual.getSamples(), expected.getSamples());
}

void
expectSameResult(SgdIcp& actual, SgdIcp& expected)
{
  EXPECT_EQ(actual.getFinalTransformation(), expected.getFinalTransformation());
  EXPECT_EQ(actual.getResult().num_iterations, expected.getResult().num_iterations);
}

void
expectResult(BayesianIcp& icp)
{
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_EQ(icp.getSamples().rows(), 40);
}

void
expectResult(SgdIcp& icp)
{
  EXPECT_TRUE(icp.hasConverged());
}

void
expectNoResult(BayesianIcp& icp)
{
  EXPECT_TRUE(icp.getSummary().status == bayesian_icp::Status::TooFewCorrespondences ||
              icp.getSummary().status == bayesian_icp::Status::InvalidInput);
  EXPECT_EQ(icp.getSamples().rows(), 0);
  EXPECT_TRUE(icp.getCovariance().array().isNaN().all());
}

void
expectInvalidInput(BayesianIcp& icp)
{
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::InvalidInput);
  expectNoResult(icp);
}

void
expectInvalidInput(SgdIcp& icp)
{
  EXPECT_EQ(icp.getResult().end, bayesian_icp::DescentEnd::InvalidInput);
}

void
expectNotRun(BayesianIcp& icp)
{
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::NotRun);
  EXPECT_EQ(icp.getSamples().rows(), 0);
}

void
expectNotRun(SgdIcp& icp)
{
  EXPECT_EQ(icp.getResult().num_iterations, 0);
}

void
expectNoResult(SgdIcp& icp)
{
  EXPECT_TRUE(icp.getResult().end == bayesian_icp::DescentEnd::TooFewCorrespondences ||
              icp.getResult().end == bayesian_icp::DescentEnd::InvalidInput);
}

template <typename Registration>
void
useMeanIfItHasOne(Registration& icp, bool is_mean)
{
  if constexpr (std::is_base_of_v<BayesianIcp, Registration>)
    icp.setUseMeanAsFinalTransformation(is_mean);
}

/** Counts the calls of every protected virtual function of PCL's ICP, and shows what
 * subclasses of ICP read after align(). */
template <typename Registration>
class Derived : public Registration {
public:
  using Registration::correspondences_;
  using typename Registration::Matrix4;
  using typename Registration::PointCloudSource;

  int num_runs = 0, num_moves = 0, num_blob_checks = 0;
  /** Added to every guess. */
  Eigen::Vector3f shift = Eigen::Vector3f::Zero();

protected:
  void
  computeTransformation(PointCloudSource& output, const Matrix4& guess) override
  {
    ++num_runs;
    Matrix4 shifted = guess;
    shifted.template topRightCorner<3, 1>() += shift;
    Registration::computeTransformation(output, shifted);
  }

  void
  transformCloud(const PointCloudSource& input,
                 PointCloudSource& output,
                 const Matrix4& transformation) override
  {
    ++num_moves;
    Registration::transformCloud(input, output, transformation);
  }

  void
  determineRequiredBlobData() override
  {
    ++num_blob_checks;
    Registration::determineRequiredBlobData();
  }
};

template <typename Registration>
class BothRegistrations : public ScansTest {
protected:
  /** Has to fail without harm, and be usable afterwards. */
  void
  expectFailure(const Cloud::Ptr& source,
                const Cloud::Ptr& target,
                const Eigen::Matrix4f& guess = Eigen::Matrix4f::Identity(),
                double max_distance = 10.0)
  {
    Registration icp;
    icp.setMaxCorrespondenceDistance(max_distance);
    output = aligned(icp, source, target, guess);
    EXPECT_FALSE(icp.hasConverged());
    EXPECT_EQ(icp.getConvergeCriteria()->getConvergenceState(),
              registration::DefaultConvergenceCriteria<
                  float>::CONVERGENCE_CRITERIA_NO_CORRESPONDENCES);
    expectNoResult(icp);
    EXPECT_EQ(output.size(), source->size());
    if (guess.allFinite()) {
      EXPECT_EQ(icp.getFinalTransformation(), guess);
    }
    icp.setMaxCorrespondenceDistance(10.0);
    align(icp);
    expectResult(icp);
  }
};

using Registrations = ::testing::Types<CalibratedIcp, PaperIcp, SgdIcp>;
TYPED_TEST_SUITE(BothRegistrations, Registrations, );

TYPED_TEST(BothRegistrations, AreHeldByThePointersOfTheirBases)
{
  const auto icp = pcl::make_shared<TypeParam>();
  EXPECT_EQ(icp->convergence_criteria_, icp->getConvergeCriteria());
  EXPECT_NE(icp->getClassName(), Icp().getClassName());
  const typename TypeParam::Ptr as_itself = icp;
  const Registration<PointXYZ, PointXYZ>::Ptr as_registration = as_itself;
  EXPECT_FALSE(as_registration->hasConverged());
  registration::IncrementalRegistration<PointXYZ> incremental;
  incremental.setRegistration(as_registration);
  EXPECT_TRUE(incremental.registerCloud(this->scans.target));
  EXPECT_TRUE(incremental.registerCloud(this->scans.source));
  EXPECT_EQ(incremental.getDeltaTransform(), icp->getFinalTransformation());
  expectResult(*icp);
}

TYPED_TEST(BothRegistrations, OverridesAreCalled)
{
  Derived<TypeParam> derived;
  this->align(derived); // as programs hold it that know PCL's class
  EXPECT_EQ(derived.num_runs, 1);
  EXPECT_GT(derived.num_moves, 0);
  EXPECT_GT(derived.num_blob_checks, 0);
  EXPECT_TRUE(derived.hasConverged());
}

TYPED_TEST(BothRegistrations, AnOverrideMayChangeWhatIsComputed)
{
  Derived<TypeParam> derived;
  derived.shift << 0.02f, -0.01f, 0.03f;
  TypeParam plain;
  this->align(derived);
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  guess.topRightCorner<3, 1>() = derived.shift;
  this->align(plain, guess);
  expectSameResult(derived, plain);
  this->align(plain);
  EXPECT_NE(derived.getFinalTransformation(), plain.getFinalTransformation());
}

TYPED_TEST(BothRegistrations, AlignIntoTheSourceGivesTheSameResultAndKeepsOtherPoints)
{
  for (const IndicesPtr& indices : {IndicesPtr(), everyNth(100, 700, 2)}) {
    Scans<PointXYZ> scans;
    TypeParam apart, in_place;
    if (indices)
      for (TypeParam* icp : {&apart, &in_place})
        icp->setIndices(indices);
    this->align(apart);
    in_place.setInputSource(scans.source);
    in_place.setInputTarget(scans.target);
    in_place.align(*scans.source);
    expectSameResult(in_place, apart);
    expectSamePoints(*scans.source, this->output);
  }
}

TYPED_TEST(BothRegistrations, ATargetThatChangedInPlaceIsSearchedAsItIsNow)
{
  for (const bool is_mean : {false, true}) {
    TypeParam reused, fresh;
    for (TypeParam* icp : {&reused, &fresh})
      useMeanIfItHasOne(*icp, is_mean);
    this->align(reused);
    for (PointXYZ& point : *this->scans.target)
      point.x += 0.02f;
    reused.align(this->output);
    this->align(fresh);
    expectSameResult(reused, fresh);
  }
}

TYPED_TEST(BothRegistrations, IndicesOfTheEstimationMayBeTakenBack)
{
  for (const bool is_mean : {false, true}) {
    TypeParam reused, fresh;
    for (TypeParam* icp : {&reused, &fresh})
      useMeanIfItHasOne(*icp, is_mean);
    const auto estimation = pcl::make_shared<Estimation>();
    reused.setCorrespondenceEstimation(estimation);
    estimation->setIndicesTarget(everyNth(0, 400));
    this->align(reused);
    estimation->setIndicesTarget(IndicesPtr());
    reused.align(this->output);
    this->align(fresh);
    expectSameResult(reused, fresh);
  }
}

TYPED_TEST(BothRegistrations, SourceIndicesOfTheEstimationMayBeAsManyAsTheLastSource)
{
  const Cloud::Ptr whole = this->scans.source;
  const auto half = everyNth(0, static_cast<index_t>(whole->size()) / 2);
  this->scans.source = pcl::make_shared<Cloud>(*whole, *half);
  TypeParam reused, fresh;
  const auto estimation = pcl::make_shared<Estimation>();
  reused.setCorrespondenceEstimation(estimation);
  this->align(reused);
  this->align(fresh);
  expectSameResult(reused, fresh);
  estimation->setIndicesSource(half);
  this->scans.source = whole;
  this->align(reused);
  fresh.setIndices(half);
  this->align(fresh);
  expectSameResult(reused, fresh);
}

TYPED_TEST(BothRegistrations, SourcePointsThatCannotBeSearchedForAreSkippedAndKept)
{
  TypeParam clean;
  this->align(clean);
  const Cloud expected = this->output;
  // Not finite, or too far for distances of floats.
  Cloud& source = *this->scans.source;
  source.insert(source.begin(), PointXYZ(1e30f, 0.0f, 0.0f));
  source.insert(source.begin() + 17, PointXYZ(1.0f, nan_value, 2.0f));
  source.insert(source.begin() + 500, PointXYZ(0.0f, -3e38f, 3e38f));
  Derived<TypeParam> holed;
  this->align(holed);
  expectSameResult(holed, clean);
  EXPECT_EQ(holed.getFitnessScore(), clean.getFitnessScore());
  ASSERT_EQ(this->output.size(), source.size());
  EXPECT_TRUE(std::isnan(this->output[17].y));
  EXPECT_EQ(this->output[1].getVector3fMap(), expected[0].getVector3fMap());
  ASSERT_EQ(holed.correspondences_->size(), source.size() - 3);
  EXPECT_EQ(holed.correspondences_->front().index_query, 1);
}

TYPED_TEST(BothRegistrations, IndicesSelectThePointsOfTheEstimate)
{
  const IndicesPtr indices = everyNth(100, 700, 2);
  const Cloud::Ptr whole = this->scans.source;
  const auto subset = pcl::make_shared<Cloud>(*whole, *indices);
  for (const bool is_reciprocal : {false, true}) {
    Derived<TypeParam> of_subset, icp;
    for (TypeParam* registration : {&of_subset, &icp})
      registration->setUseReciprocalCorrespondences(is_reciprocal);
    this->scans.source = subset;
    this->align(of_subset);
    const Cloud expected = this->output;

    this->scans.source = whole;
    icp.setIndices(indices);
    this->align(icp);
    expectSameResult(icp, of_subset);
    ASSERT_EQ(this->output.size(), whole->size()); // the whole cloud, as in PCL
    EXPECT_EQ(this->output[102].getVector3fMap(), expected[1].getVector3fMap());
    ASSERT_EQ(icp.correspondences_->size(), of_subset.correspondences_->size());
    for (std::size_t i = 0; i < icp.correspondences_->size(); ++i)
      EXPECT_EQ((*icp.correspondences_)[i].index_query,
                (*indices)[(*of_subset.correspondences_)[i].index_query]);
  }
}

TYPED_TEST(BothRegistrations, AnEmptyListOfIndicesMeansTheWholeCloud)
{
  TypeParam icp, plain;
  icp.setIndices(IndicesPtr(new Indices));
  this->align(icp);
  this->align(plain);
  expectSameResult(icp, plain);
}

TYPED_TEST(BothRegistrations, IndicesOutsideTheirCloudAreAnInvalidInput)
{
  const auto& source = this->scans.source;
  const auto& target = this->scans.target;
  const auto expectRefused = [&](const Cloud::Ptr& cloud, TypeParam& icp) {
    this->output = aligned(icp, cloud, target);
    EXPECT_FALSE(icp.hasConverged());
    expectInvalidInput(icp);
    EXPECT_EQ(this->output.size(), cloud->size());
    EXPECT_TRUE(icp.getLastIncrementalTransformation().isIdentity(0.0f));
  };
  const auto size = static_cast<index_t>(source->size());
  for (const index_t wrong : {size, index_t(-1), std::numeric_limits<index_t>::max()}) {
    TypeParam icp;
    icp.setIndices(IndicesPtr(new Indices{0, 1, 2, wrong}));
    expectRefused(source, icp);
    icp.setIndices(everyNth(0, size, 2));
    this->align(icp);
    expectResult(icp);
    // The same indices for another source.
    expectRefused(pcl::make_shared<Cloud>(*source, *everyNth(0, 200)), icp);
  }
  TypeParam icp;
  const auto estimation = pcl::make_shared<Estimation>();
  estimation->setIndicesTarget(everyNth(0, static_cast<index_t>(target->size()) + 1));
  icp.setCorrespondenceEstimation(estimation);
  expectRefused(source, icp);
  estimation->setIndicesTarget(IndicesPtr());
  estimation->setIndicesSource(everyNth(0, size + 1));
  expectRefused(source, icp);
}

TYPED_TEST(BothRegistrations, ATargetWithoutAPointToSearchIsRefused)
{
  Cloud& target = *this->scans.target;
  target.push_back({nan_value, 0.0f, 0.0f});
  const auto no_point = pcl::make_shared<Indices>();
  const auto no_finite_point =
      pcl::make_shared<Indices>(1, static_cast<index_t>(target.size()) - 1);
  for (const IndicesPtr& selected : {no_point, no_finite_point}) {
    TypeParam icp;
    const auto estimation = pcl::make_shared<Estimation>();
    estimation->setIndicesTarget(selected);
    icp.setCorrespondenceEstimation(estimation);
    this->align(icp);
    EXPECT_FALSE(icp.hasConverged());
    expectNoResult(icp);
  }
  TypeParam icp;
  icp.setSearchMethodTarget(pcl::make_shared<search::KdTree<PointXYZ>>(), true);
  this->align(icp);
  EXPECT_FALSE(icp.hasConverged());
  expectNoResult(icp);
}

TYPED_TEST(BothRegistrations, EmptiedCloudsAndMissingEstimationsAreInvalid)
{
  for (const bool is_source : {true, false}) {
    TypeParam icp;
    const auto source = pcl::make_shared<Cloud>(*this->scans.source);
    const auto target = pcl::make_shared<Cloud>(*this->scans.target);
    aligned(icp, source, target);
    expectResult(icp);
    (is_source ? source : target)->clear();
    icp.align(this->output);
    EXPECT_FALSE(icp.hasConverged());
    expectInvalidInput(icp);
  }
  for (const bool is_of_pairs : {true, false}) {
    TypeParam icp;
    if (is_of_pairs)
      icp.setCorrespondenceEstimation(nullptr);
    else
      icp.setTransformationEstimation(nullptr);
    this->align(icp);
    EXPECT_FALSE(icp.hasConverged());
    expectInvalidInput(icp);
  }
}

TYPED_TEST(BothRegistrations, MayBeMadeByNewThatDoesNotThrow)
{
  const std::unique_ptr<TypeParam> icp(new (std::nothrow) TypeParam);
  this->align(*icp);
  expectResult(*icp);
}

TYPED_TEST(BothRegistrations, ARefusedCloudIsAnInvalidInputUntilAnotherIsSet)
{
  TypeParam icp;
  Registration<PointXYZ, PointXYZ>& as_pcl_knows_it = icp;
  for (const Cloud::Ptr& refused : {Cloud::Ptr(), Cloud::Ptr(new Cloud)})
    for (const bool is_source : {true, false}) {
      this->align(icp);
      expectResult(icp);
      if (is_source)
        icp.setInputSource(refused);
      else
        icp.setInputTarget(refused);
      for (const bool is_by_pcl : {false, true}) {
        this->output.resize(3);
        if (is_by_pcl)
          as_pcl_knows_it.align(this->output);
        else
          icp.align(this->output);
        EXPECT_FALSE(icp.hasConverged());
        expectInvalidInput(icp);
        EXPECT_EQ(this->output.size(), is_source ? 0 : this->scans.source->size());
        EXPECT_EQ(icp.getFitnessScore(), std::numeric_limits<double>::max());
      }
    }
  this->align(icp);
  expectResult(icp);
}

TYPED_TEST(BothRegistrations, AMissingOrRefusedFirstCloudIsAnInvalidInput)
{
  TypeParam icps[4]; // the last one has no cloud at all
  icps[0].setInputSource(this->scans.source);
  icps[1].setInputTarget(this->scans.target);
  icps[2].setInputSource(Cloud::Ptr(new Cloud));
  icps[2].setInputTarget(Cloud::Ptr());
  for (TypeParam& icp : icps) {
    icp.align(this->output);
    EXPECT_FALSE(icp.hasConverged());
    expectInvalidInput(icp);
    EXPECT_EQ(icp.getFitnessScore(), std::numeric_limits<double>::max());
  }
}

TYPED_TEST(BothRegistrations, TargetPointsThatAreNotSelectedAreNotSearched)
{
  TypeParam plain, with_indices, with_tree;
  this->align(plain);
  const IndicesPtr selected =
      everyNth(0, static_cast<index_t>(this->scans.target->size()));
  // Ready to be matched, were it not for the indices.
  *this->scans.target += *this->scans.source;
  const auto estimation = pcl::make_shared<Estimation>();
  estimation->setIndicesTarget(selected);
  with_indices.setCorrespondenceEstimation(estimation);
  this->align(with_indices);
  expectSameResult(with_indices, plain);
  const auto ready_tree = pcl::make_shared<OwnSearch>();
  ready_tree->setInputCloud(this->scans.target, selected);
  with_tree.setSearchMethodTarget(ready_tree, true);
  this->align(with_tree);
  expectSameResult(with_tree, plain);
  EXPECT_EQ(ready_tree->num_builds, 1);
  TypeParam all_points;
  this->align(all_points);
  EXPECT_NE(all_points.getFinalTransformation(), plain.getFinalTransformation());
}

TYPED_TEST(BothRegistrations, ExceptionsOfTheSearchTreePassThrough)
{
  struct Tree : search::KdTree<PointXYZ> {
    bool is_broken = false;

    void
    setInputCloud(const Cloud::ConstPtr& cloud, const IndicesConstPtr& indices) override
    {
      if (is_broken)
        throw std::runtime_error("of the user");
      search::KdTree<PointXYZ>::setInputCloud(cloud, indices);
    }
  };
  TypeParam icp;
  const auto tree = pcl::make_shared<Tree>();
  icp.setSearchMethodTarget(tree);
  this->align(icp);
  expectResult(icp);
  tree->is_broken = true;
  icp.setInputTarget(pcl::make_shared<Cloud>(*this->scans.target));
  EXPECT_THROW(icp.align(this->output), std::runtime_error);
  EXPECT_FALSE(icp.hasConverged());
  expectNotRun(icp);
}

TYPED_TEST(BothRegistrations, ExceptionsOfTheCallbackPassThrough)
{
  for (const int last : {2, 20}) { // in ICP, and among the draws
    TypeParam icp;
    int num_calls = 0;
    icp.setProgressCallback([&](auto...) -> bool {
      if (++num_calls > last)
        throw std::runtime_error("of the user");
      return (true);
    });
    EXPECT_THROW(this->align(icp), std::runtime_error);
    EXPECT_FALSE(icp.hasConverged());
    expectNotRun(icp);
    icp.setProgressCallback(nullptr);
    this->align(icp);
    expectResult(icp);
  }
}

TYPED_TEST(BothRegistrations, CloudsThatCannotBeRegisteredFail)
{
  const Cloud::Ptr none(new Cloud(10, 1, PointXYZ(nan_value, 0.0f, 0.0f)));
  const Cloud::Ptr two_points(new Cloud(2, 1, PointXYZ(1.0f, 0.0f, 0.0f)));
  this->expectFailure(none, this->scans.target);
  this->expectFailure(this->scans.source, none);
  this->expectFailure(two_points, this->scans.target);
}

TYPED_TEST(BothRegistrations, GuessesThatAreOfNoUseFail)
{
  const auto& [source, target] = this->scans;
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  guess(0, 3) = 100.0f; // no overlap
  this->expectFailure(source, target, guess, 0.1);
  guess(0, 3) = 0.0f;
  guess(1, 1) = nan_value;
  this->expectFailure(source, target, guess);
  for (const float x : {1e30f, 3e38f}) { // too far for distances of floats
    guess.setIdentity();
    guess.topRightCorner<3, 1>().setConstant(x);
    guess(0, 0) = x;
    this->expectFailure(source, target, guess);
  }
}

} // namespace
} // namespace pcl::test
